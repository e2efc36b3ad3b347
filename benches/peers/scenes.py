"""The scene files that both renderers read, and how they are prepared."""

import re
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Scene:
    """One scene file, its parameters and the path depth at which it is compared."""

    name: str
    file: str
    width: int
    height: int
    max_depth: int
    parameters: tuple = ()
    # Texts of the file and what stands in their place, in the files of both renderers.
    replacements: tuple = ()

    def size(self, scale):
        """Image size at `scale` times the film size of the file."""
        return max(1, round(self.width * scale)), max(1, round(self.height * scale))


# Sizes and depths are those of the files, but for veach-mis, whose depth 3 would leave out all interreflection.
SCENES = [
    Scene("cornell-box", "cornell-box/scene.xml", 1024, 1024, 30, (("integrator", "path"),)),
    Scene("veach-mis", "veach-mis/scene.xml", 1280, 720, 10, (("integrator", "path"),)),
    Scene("modern-hall", "modern-hall/scene_mi3.xml", 1280, 720, 65),
    Scene("living-room", "living-room/scene_mi3.xml", 1280, 720, 65),
    Scene("water-caustic", "water-caustic/scene_mi3.xml", 1024, 1024, 9),
    # The lamp of water-caustic is 5 mm by 4 mm: what arrives through the water is found by chance, and so rarely that no affordable
    # number of samples gives the mean a normal distribution. A hundred times as long and as wide, at the same power.
    Scene("water-caustic-large-lamp", "water-caustic/scene_mi3.xml", 1024, 1024, 9, (), (
        ("-0.0025 1.91069e-015 -4.37114e-008 -0.005 2.18557e-010 2.18557e-008 -0.5 1.98 0 -0.002 -8.74228e-011 -0.03",
         "-0.25 1.91069e-013 -4.37114e-008 -0.005 2.18557e-008 2.18557e-006 -0.5 1.98 0 -0.2 -8.74228e-011 -0.03"),
        ("541127, 381972, 127324", "54.1127, 38.1972, 12.7324"),
    )),
]


def select(names):
    """The scenes called `names`, in the order of the table; all of them when `names` is empty."""
    unknown = set(names) - {scene.name for scene in SCENES}
    if unknown:
        raise SystemExit(f"unknown scene {sorted(unknown)[0]}; known: {', '.join(s.name for s in SCENES)}")
    return [scene for scene in SCENES if not names or scene.name in names]


def with_box_filter(scene, assets, folder):
    """A copy of the scene file whose reconstruction filter is a box, next to links to everything it refers to.

    Nothing else changes but the scene's replacements. With a box the pixels are independent and no renderer's filter enters the
    comparison.
    """
    original = Path(assets).resolve() / scene.file
    target = Path(folder) / scene.name
    target.mkdir(parents=True, exist_ok=True)
    for entry in original.parent.iterdir():
        if entry != original and not (target / entry.name).exists():
            (target / entry.name).symlink_to(entry)
    text, count = re.subn(r'(<rfilter\b[^>]*\btype=")\w+(")', r"\g<1>box\2", original.read_text())
    if count != 1:
        raise SystemExit(f"{original}: expected one rfilter, found {count}")
    for old, new in scene.replacements:
        if text.count(old) != 1:
            raise SystemExit(f"{original}: expected '{old}' once, found it {text.count(old)} times")
        text = text.replace(old, new)
    (target / original.name).write_text(text)
    return target / original.name
