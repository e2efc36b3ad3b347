// The script of all pages: the theme button, and the viewer of images where there is one.
//
// Images are half floats. A half has 65536 values, so whatever an image is shown with (exposure, tone curve, colours) is a table of 65536
// entries that is made once for each setting, and drawing a pixel is looking it up.
"use strict";

(() => {
  // ---- numbers ----

  /** The value of each half float, by its bits. */
  const HALVES = Float32Array.from({ length: 65536 }, (_, bits) => {
    const sign = bits & 0x8000 ? -1 : 1;
    const exponent = (bits >> 10) & 31;
    const fraction = bits & 1023;
    if (exponent === 31) return fraction ? NaN : sign * Infinity;
    return sign * (exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -24 * fraction);
  });

  /** Halves from base64, as bits. Little-endian in the page; read so on any machine. */
  function decode(text) {
    const bytes = atob(text);
    const halves = new Uint16Array(bytes.length / 2);
    for (let i = 0; i < halves.length; i++) halves[i] = bytes.charCodeAt(2 * i) | (bytes.charCodeAt(2 * i + 1) << 8);
    return halves;
  }

  const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
  const encodeSrgb = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
  // K. Narkowicz's fit of ACES, with the factor 0.6 on its input, as HDR-FLIP has it.
  const aces = (x) => ((y) => (y * (2.51 * y + 0.03)) / (y * (2.43 * y + 0.59) + 0.14))(0.6 * x);

  const CURVES = {
    srgb: (x) => encodeSrgb(clamp(x, 0, 1)),
    aces: (x) => encodeSrgb(clamp(aces(Math.min(x, 1e6)), 0, 1)),
    linear: (x) => clamp(x, 0, 1),
  };

  // Nine colours of matplotlib's maps, evenly spaced.
  const COLOURS = {
    magma: ["#000004", "#1d1147", "#51127c", "#832681", "#b73779", "#e75263", "#fc8961", "#fec488", "#fcfdbf"],
    viridis: ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"],
  };

  /** The colour at `t` between 0 and 1, as three bytes. */
  function colourAt(name, t) {
    const stops = COLOURS[name];
    const place = clamp(t, 0, 1) * (stops.length - 1);
    const index = Math.min(Math.floor(place), stops.length - 2);
    const part = (stop, i) => parseInt(stop.slice(1 + 2 * i, 3 + 2 * i), 16);
    return [0, 1, 2].map((i) => part(stops[index], i) + (place - index) * (part(stops[index + 1], i) - part(stops[index], i)));
  }

  /** Where a number is on the scale of a map. */
  function shareOf(picture, value) {
    const { low, high, log } = picture;
    if (!log) return (value - low) / (high - low);
    return value > 0 ? Math.log(value / low) / Math.log(high / low) : 0;
  }

  /** Four digits, and as short as that goes. */
  function readable(x) {
    if (!Number.isFinite(x)) return String(x);
    return x === 0 ? "0" : Math.abs(x) < 1e-3 || Math.abs(x) >= 1e5 ? x.toExponential(2) : x.toPrecision(4);
  }

  /** Three digits at most, without zeros at the end. */
  const short = (x) => String(Number(x.toPrecision(3)));

  const BROKEN = [255, 0, 255];

  // ---- pictures ----

  /** One image: its halves, and a canvas with its colours as they were last asked for. */
  class Picture {
    constructor(description, text) {
      Object.assign(this, description);
      this.halves = decode(text);
      this.canvas = document.createElement("canvas");
      this.canvas.width = this.width;
      this.canvas.height = this.height;
      this.drawn = null;
    }

    /** The canvas, drawn anew if exposure or curve are others than before. */
    shown(exposure, curve) {
      const setting = this.kind === "radiance" ? `${exposure} ${curve}` : "fixed";
      if (this.drawn !== setting) {
        const context = this.canvas.getContext("2d");
        const image = context.createImageData(this.width, this.height);
        if (this.kind === "map") this.fillMap(image.data);
        else this.fillColours(image.data, this.table(exposure, curve));
        context.putImageData(image, 0, 0);
        this.drawn = setting;
      }
      return this.canvas;
    }

    /** From the bits of a channel to a byte. */
    table(exposure, curve) {
      const byte = {
        radiance: (x) => CURVES[curve](x * 2 ** exposure),
        albedo: CURVES.srgb,
        normal: (x) => clamp(0.5 + 0.5 * x, 0, 1),
      }[this.kind];
      return Uint8Array.from(HALVES, (x) => Math.round(255 * byte(Number.isNaN(x) ? 0 : x)));
    }

    fillColours(data, table) {
      for (let i = 0, from = 0; i < data.length; i += 4, from += 3) {
        data[i] = table[this.halves[from]];
        data[i + 1] = table[this.halves[from + 1]];
        data[i + 2] = table[this.halves[from + 2]];
        data[i + 3] = 255;
      }
    }

    fillMap(data) {
      const table = new Map();
      this.halves.forEach((bits, pixel) => {
        let colour = table.get(bits);
        if (!colour) {
          colour = Number.isNaN(HALVES[bits]) ? BROKEN : colourAt(this.colours, shareOf(this, HALVES[bits]));
          table.set(bits, colour);
        }
        data.set([...colour, 255], 4 * pixel);
      });
    }

    /** The numbers of a pixel, for people. */
    at(x, y) {
      const start = (y * this.width + x) * this.channels;
      return Array.from(this.halves.subarray(start, start + this.channels), (bits) => readable(HALVES[bits])).join("  ");
    }

    /** The scale of a map; nothing for other images. */
    bar() {
      if (this.kind !== "map") return null;
      const bar = element("span", "bar");
      const ramp = element("span", "ramp");
      ramp.style.background = `linear-gradient(90deg, ${COLOURS[this.colours].join(", ")})`;
      const ends = element("span", "ends");
      ends.append(element("span", "", short(this.low)), element("span", "", `${short(this.high)}${this.log ? ", log" : ""}`));
      bar.append(ramp, ends);
      return bar;
    }
  }

  /** Names of estimators have no spaces: they may be broken before their options. */
  const breakable = (name) => name.replaceAll(":", "\u200b:");

  function element(tag, className = "", text = "") {
    const made = document.createElement(tag);
    made.className = className;
    made.textContent = text;
    return made;
  }

  // ---- the viewer ----

  /** Pixels of the screen around the dividing line that take hold of it. */
  const GRIP = 14;
  const MAX_ZOOM = 64;

  class Viewer {
    constructor(root) {
      this.root = root;
      const descriptions = JSON.parse(root.querySelector("script.picture-data").textContent);
      const texts = root.querySelectorAll("script.pixels");
      this.pictures = descriptions.map((description, i) => new Picture(description, texts[i].textContent));
      texts.forEach((script) => script.remove());
      const of = (name) => root.querySelector(`.${name}`);
      for (const name of ["screen", "wipe", "exposure", "stops", "curve", "zoom", "readout", "status", "gallery"]) this[name] = of(name);
      this.selects = { left: of("controls").querySelector("select.left"), right: of("controls").querySelector("select.right") };
      this.names = { left: of("left-name"), right: of("right-name") };
      this.values = { at: of("at"), left: of("left-value"), right: of("right-value") };
      this.initialExposure = Number(root.dataset.exposure);
      this.exposure.value = this.initialExposure;
      // How many pixels of the screen one of the image has, in CSS pixels, and where the image's corner is.
      this.view = { scale: 1, x: 0, y: 0 };
      this.fitted = true;
      this.makeGallery();
      this.listen(of);
      new ResizeObserver(() => this.resize()).observe(this.screen.parentElement);
      this.resize();
      this.update();
    }

    picture(side) {
      return this.pictures[Number(this.selects[side].value)];
    }

    // -- what users do --

    listen(of) {
      for (const side of ["left", "right"]) this.selects[side].addEventListener("change", () => this.update());
      this.wipe.addEventListener("input", () => this.requestDraw());
      this.exposure.addEventListener("input", () => this.update());
      this.curve.addEventListener("change", () => this.update());
      of("swap").addEventListener("click", () => this.swap());
      of("reset").addEventListener("click", () => this.setExposure(this.initialExposure));
      of("zoom-in").addEventListener("click", () => this.zoomBy(2));
      of("zoom-out").addEventListener("click", () => this.zoomBy(0.5));
      of("fit").addEventListener("click", () => this.fit());
      of("whole").addEventListener("click", () => this.zoomBy(1 / (this.view.scale * window.devicePixelRatio)));
      this.root.addEventListener("keydown", (event) => this.key(event));
      this.screen.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
      this.screen.addEventListener("pointerdown", (event) => this.grab(event));
      this.screen.addEventListener("pointermove", (event) => this.read(event));
      this.screen.addEventListener("pointerleave", () => this.read(null));
    }

    key(event) {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      // A list has its own use for arrows, digits and letters.
      if (event.target.tagName === "SELECT") return;
      const onRange = event.target.type === "range";
      const digit = /^(Digit|Numpad)([0-9])$/.exec(event.code)?.[2] ?? (/^[0-9]$/.test(event.key) ? event.key : null);
      if (digit !== null && digit !== "0") this.choose(event.shiftKey ? "right" : "left", Number(digit) - 1);
      else if (digit === "0") this.fit();
      else if (event.key === "+" || event.key === "=") this.setExposure(Number(this.exposure.value) + 0.5);
      else if (event.key === "-" || event.key === "−") this.setExposure(Number(this.exposure.value) - 0.5);
      else if (event.key === "x") this.swap();
      else if (event.key === "[") this.zoomBy(0.5);
      else if (event.key === "]") this.zoomBy(2);
      else if (event.key.startsWith("Arrow") && event.shiftKey) this.panByKey(event.key);
      else if ((event.key === "ArrowLeft" || event.key === "ArrowRight") && !onRange) {
        this.setWipe(Number(this.wipe.value) + (event.key === "ArrowLeft" ? -2 : 2));
      } else return;
      event.preventDefault();
    }

    panByKey(key) {
      const step = 0.1 * this.screen.clientWidth;
      const [x, y] = { ArrowLeft: [step, 0], ArrowRight: [-step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[key];
      this.view.x += x;
      this.view.y += y;
      this.requestDraw();
    }

    choose(side, index) {
      if (index >= this.pictures.length) return;
      this.selects[side].value = index;
      this.update();
    }

    swap() {
      [this.selects.left.value, this.selects.right.value] = [this.selects.right.value, this.selects.left.value];
      this.update();
    }

    setWipe(percent) {
      this.wipe.value = percent;
      this.requestDraw();
    }

    setExposure(stops) {
      this.exposure.value = stops;
      this.update();
    }

    /** Zooms around a place of the screen, its middle by default. */
    zoomBy(factor, x = this.screen.clientWidth / 2, y = this.screen.clientHeight / 2) {
      const { view } = this;
      const scale = clamp(view.scale * factor, 0.25 * this.fitScale(), Math.max(MAX_ZOOM, this.fitScale()));
      view.x = x - ((x - view.x) * scale) / view.scale;
      view.y = y - ((y - view.y) * scale) / view.scale;
      view.scale = scale;
      this.fitted = false;
      this.requestDraw();
    }

    wheel(event) {
      // The page scrolls, unless the image has the focus or is pinched.
      if (document.activeElement !== this.screen && !event.ctrlKey) return;
      event.preventDefault();
      const box = this.screen.getBoundingClientRect();
      this.zoomBy(2 ** (-event.deltaY / 240), event.clientX - box.left, event.clientY - box.top);
    }

    /** Drags the dividing line, or the image once it is larger than its place. */
    grab(event) {
      if (event.button !== 0) return;
      this.screen.focus({ preventScroll: true });
      this.screen.setPointerCapture(event.pointerId);
      const box = this.screen.getBoundingClientRect();
      const line = (Number(this.wipe.value) / 100) * box.width;
      const wipes = this.fitted || Math.abs(event.clientX - box.left - line) < GRIP;
      const start = { x: this.view.x - event.clientX, y: this.view.y - event.clientY };
      const move = (to) => {
        if (wipes) return this.setWipe((100 * (to.clientX - box.left)) / box.width);
        this.view.x = start.x + to.clientX;
        this.view.y = start.y + to.clientY;
        this.requestDraw();
      };
      const end = () => {
        this.screen.removeEventListener("pointermove", move);
        for (const name of ["pointerup", "pointercancel"]) this.screen.removeEventListener(name, end);
      };
      this.screen.addEventListener("pointermove", move);
      for (const name of ["pointerup", "pointercancel"]) this.screen.addEventListener(name, end);
      if (wipes) move(event);
    }

    /** Shows the numbers of the pixel below the pointer. */
    read(event) {
      const box = this.screen.getBoundingClientRect();
      const place = (client, start, corner) => Math.floor((client - start - corner) / this.view.scale);
      const x = event ? place(event.clientX, box.left, this.view.x) : -1;
      const y = event ? place(event.clientY, box.top, this.view.y) : -1;
      const { width, height } = this.pictures[0];
      const inside = x >= 0 && y >= 0 && x < width && y < height;
      this.values.at.textContent = inside ? `(${x}, ${y})` : "Move over the image to read pixels.";
      for (const side of ["left", "right"]) {
        this.values[side].textContent = inside ? `${side} ${this.picture(side).at(x, y)}` : "";
      }
    }

    // -- what is seen --

    fitScale() {
      const { width, height } = this.pictures[0];
      return Math.min(this.screen.clientWidth / width, this.screen.clientHeight / height);
    }

    fit() {
      const { width, height } = this.pictures[0];
      const scale = this.fitScale();
      const corner = (room, size) => (room - size * scale) / 2;
      this.view = { scale, x: corner(this.screen.clientWidth, width), y: corner(this.screen.clientHeight, height) };
      this.fitted = true;
      this.requestDraw();
    }

    /** Gives the screen as much height as the image needs, if the window has it. */
    resize() {
      const { width, height } = this.pictures[0];
      const room = this.screen.parentElement.clientWidth;
      if (!room) return;
      this.screen.style.height = `${Math.round(Math.min((room * height) / width, 0.72 * window.innerHeight))}px`;
      this.screen.width = Math.round(this.screen.clientWidth * window.devicePixelRatio);
      this.screen.height = Math.round(this.screen.clientHeight * window.devicePixelRatio);
      if (this.fitted) this.fit();
      // At once: a canvas that was resized is empty until then.
      this.draw();
    }

    /** After a change of what is shown: controls, names, thumbnails. */
    update() {
      const stops = Number(this.exposure.value);
      this.stops.textContent = `${stops > 0 ? "+" : ""}${stops} stops`;
      for (const side of ["left", "right"]) {
        const picture = this.picture(side);
        this.names[side].replaceChildren(picture.name, ...[picture.bar()].filter(Boolean));
      }
      const sides = (i) => ["left", "right"].filter((side) => Number(this.selects[side].value) === i);
      this.thumbs.forEach(({ button, where }, i) => {
        button.setAttribute("aria-pressed", String(sides(i).length > 0));
        where.textContent = sides(i).join(", ");
      });
      this.status.textContent = `Left ${this.picture("left").name}, right ${this.picture("right").name}, exposure ${stops} stops`;
      this.requestDraw();
      // Dragging a slider changes all images many times: the small ones can wait.
      clearTimeout(this.thumbTimer);
      this.thumbTimer = setTimeout(() => this.drawThumbs(), 120);
    }

    requestDraw() {
      this.frame ??= requestAnimationFrame(() => this.draw());
    }

    draw() {
      this.frame = null;
      const { screen, view } = this;
      const ratio = window.devicePixelRatio;
      const context = screen.getContext("2d");
      const line = Math.round((Number(this.wipe.value) / 100) * screen.width);
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.clearRect(0, 0, screen.width, screen.height);
      // Enlarged pixels stay squares.
      context.imageSmoothingEnabled = view.scale * ratio < 1;
      this.drawSide(context, "left", 0, line);
      this.drawSide(context, "right", line, screen.width);
      if (line > 0 && line < screen.width) {
        context.fillStyle = "#fff";
        context.fillRect(line - ratio, 0, 2 * ratio, screen.height);
        context.fillStyle = "#000";
        context.fillRect(line + ratio, 0, ratio, screen.height);
      }
      this.names.left.hidden = line === 0;
      this.names.right.hidden = line === screen.width;
      this.zoom.textContent = `${Math.round(100 * view.scale * ratio)} %`;
      this.screen.style.cursor = this.fitted ? "ew-resize" : "grab";
    }

    drawSide(context, side, from, to) {
      if (from >= to) return;
      const picture = this.picture(side);
      const ratio = window.devicePixelRatio;
      const { scale, x, y } = this.view;
      const canvas = picture.shown(Number(this.exposure.value), this.curve.value);
      context.save();
      context.beginPath();
      context.rect(from, 0, to - from, this.screen.height);
      context.clip();
      context.drawImage(canvas, x * ratio, y * ratio, picture.width * scale * ratio, picture.height * scale * ratio);
      context.restore();
    }

    // -- all images, to choose from and for paper --

    makeGallery() {
      this.thumbs = this.pictures.map((picture, i) => {
        const button = element("button", "thumb");
        button.type = "button";
        const canvas = element("canvas");
        const scale = Math.min(1, 640 / picture.width);
        canvas.width = Math.max(1, Math.round(picture.width * scale));
        canvas.height = Math.max(1, Math.round(picture.height * scale));
        canvas.setAttribute("aria-hidden", "true");
        // Few pixels stay squares.
        canvas.style.imageRendering = picture.width < 160 ? "pixelated" : "auto";
        const where = element("span", "where");
        button.append(canvas, element("span", "name", `${i + 1} ${breakable(picture.name)}`), where, ...[picture.bar()].filter(Boolean));
        button.addEventListener("click", (event) => this.choose(event.shiftKey ? "right" : "left", i));
        this.gallery.append(button);
        return { button, canvas, where };
      });
    }

    drawThumbs() {
      this.thumbs.forEach(({ canvas }, i) => {
        const source = this.pictures[i].shown(Number(this.exposure.value), this.curve.value);
        const context = canvas.getContext("2d");
        context.imageSmoothingQuality = "high";
        context.drawImage(source, 0, 0, canvas.width, canvas.height);
      });
    }
  }

  // ---- the page ----

  const theme = document.querySelector("button.theme");
  const themes = ["system", "light", "dark"];
  theme?.addEventListener("click", () => {
    const next = themes[(themes.indexOf(document.documentElement.dataset.theme ?? "system") + 1) % themes.length];
    document.documentElement.dataset.theme = next;
    theme.textContent = `Theme: ${next}`;
  });

  const viewers = Array.from(document.querySelectorAll(".viewer"), (root) => new Viewer(root));

  // Paper has no use for what is folded away.
  let folded = [];
  window.addEventListener("beforeprint", () => {
    folded = Array.from(document.querySelectorAll("details:not([open])"));
    folded.forEach((details) => (details.open = true));
    viewers.forEach((viewer) => viewer.drawThumbs());
  });
  window.addEventListener("afterprint", () => folded.forEach((details) => (details.open = false)));
})();
