//! The image so far, in a viewer.

use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use scene_core::film::LayeredImage;
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};
use thiserror::Error;

/// How long a viewer may take to answer, or to take its data.
const TIMEOUT: Duration = Duration::from_secs(3);
/// Least time between two updates that are sent only when [due](Display::is_due).
const INTERVAL: Duration = Duration::from_millis(500);
/// Values per packet: the viewer allocates whole packets.
const VALUES_PER_PACKET: usize = 1 << 20;

/// The viewer is out of reach. Say so once, and go on rendering.
#[derive(Debug, Error)]
#[error("no display at {server}: {source}")]
pub struct DisplayError {
    /// Host and port.
    pub server: String,
    /// What the system says.
    pub source: io::Error,
}

/// A connection to [tev](https://github.com/Tom94/tev), or to anything else that speaks its protocol.
///
/// Rendering does not depend on it: the first failure is returned for a warning, after that the connection counts as
/// closed and updates do nothing.
///
/// ```
/// use lichtwerk::output::Display;
/// use scene_core::film::LayeredImage;
///
/// let error = Display::connect("localhost:1", "render").map(drop).unwrap_err();
/// assert!(error.to_string().starts_with("no display at localhost:1: "));
///
/// let mut display = Display::none(); // what to go on with
/// display.update(&LayeredImage::new(4, 4)?)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Display {
    client: Option<TevClient>,
    server: String,
    image_name: String,
    /// Size and channels of the image that the viewer has.
    created: Option<(u32, u32, Vec<String>)>,
    last_update: Option<Instant>,
}

impl Display {
    /// No viewer: updates do nothing.
    pub fn none() -> Self {
        Self { client: None, server: String::new(), image_name: String::new(), created: None, last_update: None }
    }

    /// Connects to the viewer at `HOST:PORT` (tev listens on port 14158), which will call the image by this name.
    ///
    /// # Errors
    /// [`DisplayError`] if the name does not resolve or nobody answers within three seconds.
    pub fn connect(server: &str, image_name: &str) -> Result<Self, DisplayError> {
        let failed = |source| DisplayError { server: server.to_owned(), source };
        let socket = connect(server).map_err(failed)?;
        Ok(Self {
            client: Some(TevClient::wrap(socket)),
            server: server.to_owned(),
            image_name: image_name.replace('\0', " "),
            ..Self::none()
        })
    }

    /// Whether there is a viewer to send to.
    pub fn is_connected(&self) -> bool {
        self.client.is_some()
    }

    /// Whether there is a viewer and its last update is half a second ago: ask before developing the film.
    pub fn is_due(&self) -> bool {
        self.is_connected() && self.last_update.is_none_or(|last| last.elapsed() >= INTERVAL)
    }

    /// Sends all channels of the image.
    ///
    /// # Errors
    /// [`DisplayError`] when the connection breaks; it is closed then, and later updates succeed by doing nothing.
    pub fn update(&mut self, image: &LayeredImage) -> Result<(), DisplayError> {
        self.update_rows(image, 0..image.height())
    }

    /// Sends the given rows of all channels of the image. The first update of an image creates it in the viewer.
    ///
    /// # Errors
    /// As for [`update`](Self::update).
    pub fn update_rows(&mut self, image: &LayeredImage, rows: std::ops::Range<u32>) -> Result<(), DisplayError> {
        let Some(client) = &mut self.client else { return Ok(()) };
        let sent = create(client, &self.image_name, &mut self.created, image)
            .and_then(|()| send_rows(client, &self.image_name, image, rows));
        self.last_update = Some(Instant::now());
        sent.map_err(|source| {
            self.client = None;
            DisplayError { server: self.server.clone(), source }
        })
    }
}

fn connect(server: &str) -> io::Result<TcpStream> {
    let mut failure = io::Error::new(io::ErrorKind::InvalidInput, "the name has no address");
    for address in server.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, TIMEOUT) {
            Ok(socket) => {
                socket.set_write_timeout(Some(TIMEOUT))?;
                return Ok(socket);
            }
            Err(error) => failure = error,
        }
    }
    Err(failure)
}

fn create(
    client: &mut TevClient,
    image_name: &str,
    created: &mut Option<(u32, u32, Vec<String>)>,
    image: &LayeredImage,
) -> io::Result<()> {
    let channels: Vec<String> = image.channels().map(|(name, _)| name.to_owned()).collect();
    let shape = (image.width(), image.height(), channels);
    if created.as_ref() == Some(&shape) || shape.2.is_empty() {
        return Ok(());
    }
    let (width, height, channel_names) = (shape.0, shape.1, &shape.2[..]);
    client.send(PacketCreateImage { image_name, grab_focus: false, width, height, channel_names })?;
    *created = Some(shape);
    Ok(())
}

/// Sends bands of rows, the channels of a band one after the other.
fn send_rows(
    client: &mut TevClient,
    image_name: &str,
    image: &LayeredImage,
    rows: std::ops::Range<u32>,
) -> io::Result<()> {
    let names: Vec<&str> = image.channels().map(|(name, _)| name).collect();
    if names.is_empty() {
        return Ok(());
    }
    let width = image.width() as usize;
    let band = (VALUES_PER_PACKET / (width * names.len())).max(1) as u32;
    let end = rows.end.min(image.height());
    for y in (rows.start..end).step_by(band as usize) {
        let height = band.min(end - y);
        let pixels = y as usize * width..(y + height) as usize * width;
        let data: Vec<f32> = image.channels().flat_map(|(_, values)| values[pixels.clone()].iter().copied()).collect();
        let offsets: Vec<u64> = (0..names.len()).map(|channel| (channel * pixels.len()) as u64).collect();
        client.send(PacketUpdateImage {
            image_name,
            grab_focus: false,
            channel_names: &names,
            channel_offsets: &offsets,
            channel_strides: &vec![1; names.len()],
            x: 0,
            y,
            width: image.width(),
            height,
            data: &data,
        })?;
    }
    Ok(())
}
