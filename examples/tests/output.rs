//! Files that survive whatever happens, the viewer, Ctrl-C.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod signals;

use std::fs;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use lichtwerk::output::{
    Display, ImageFormat, Interrupt, OutputError, check_writable, save_image, write_atomically, write_json,
};
use scene_core::film::LayeredImage;

/// Set in processes that a test starts to be killed: what the helper below works on.
const CHILD: &str = "LICHTWERK_TEST_CHILD";

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn image() -> LayeredImage {
    let mut image = LayeredImage::new(64, 64).unwrap();
    image.set_rgb(&(0..64 * 64).map(|i| [(i as f32).sin(), (i as f32).cos(), 0.5]).collect::<Vec<_>>()).unwrap();
    image
}

/// Runs one of this program's own tests in a process of its own, and waits until it says that it is ready.
fn spawn(test: &str, argument: &str) -> (Child, impl BufRead + use<>) {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", test, "--nocapture"])
        .env(CHILD, argument)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut output = BufReader::new(child.stdout.take().unwrap());
    await_line(&mut output, "ready");
    (child, output)
}

fn await_line(output: &mut impl BufRead, expected: &str) {
    let mut line = String::new();
    while !line.trim_end().ends_with(expected) {
        line.clear();
        assert_ne!(output.read_line(&mut line).unwrap(), 0, "the process ended before it said '{expected}'");
    }
}

fn say(word: &str) {
    println!("\n{word}");
    io::stdout().flush().unwrap();
}

#[test]
fn a_failing_writer_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("image.exr");
    write_atomically(&path, |file| file.write_all(b"old")).unwrap();
    let error = write_atomically(&path, |file| {
        file.write_all(&[0; 100_000])?;
        Err(io::Error::other("power failure"))
    })
    .unwrap_err();
    let message = error.to_string();
    assert!(message.contains("image.exr") && message.contains("power failure") && !message.contains('\n'), "{message}");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["image.exr"]);

    write_atomically(&path, |file| file.write_all(b"new")).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(names(folder.path()), ["image.exr"]);
}

#[test]
fn impossible_paths_are_one_line_errors_that_name_the_path() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("no/such/folder.exr");
    for path in [missing.as_path(), folder.path(), Path::new("/proc/image.exr"), Path::new("/"), Path::new("")] {
        for error in [write_atomically(path, |_| Ok(())).unwrap_err(), check_writable(path).unwrap_err()] {
            let message = error.to_string();
            assert!(message.starts_with(&format!("cannot write {}: ", path.display())), "{message}");
            assert!(!message.contains('\n') && !message.contains("at path"), "{message}");
        }
    }
    check_writable(&folder.path().join("new.exr")).unwrap();
    assert!(names(folder.path()).is_empty());
}

#[cfg(unix)]
#[test]
fn permissions_and_links_are_respected() {
    use std::os::unix::fs::{PermissionsExt, symlink};

    let folder = tempfile::tempdir().unwrap();
    let (file, link) = (folder.path().join("file.json"), folder.path().join("link.json"));
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    fs::write(folder.path().join("plain"), "").unwrap();
    write_json(&file, &[1, 2]).unwrap();
    assert_eq!(mode(&file), mode(&folder.path().join("plain")), "a new file gets the usual permissions");
    fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
    symlink(&file, &link).unwrap();
    write_json(&link, &[3]).unwrap();
    assert_eq!(mode(&file), 0o640);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(&file).unwrap(), "[\n  3\n]\n");

    fs::set_permissions(&file, fs::Permissions::from_mode(0o440)).unwrap();
    assert!(write_json(&file, &[4]).is_err(), "a file that was made read-only is not replaced");
    assert_eq!(fs::read_to_string(&file).unwrap(), "[\n  3\n]\n");
}

#[cfg(target_os = "linux")]
#[test]
fn devices_are_written_to_and_not_replaced() {
    write_atomically(Path::new("/dev/null"), |file| file.write_all(b"away")).unwrap();
    let error = write_atomically(Path::new("/dev/full"), |file| file.write_all(&[0; 4096])).unwrap_err();
    assert!(
        matches!(&error, OutputError::Write { source, .. } if source.kind() == io::ErrorKind::StorageFull),
        "{error}"
    );
    assert!(fs::symlink_metadata("/dev/null").unwrap().file_type().is_file().eq(&false));
}

/// A file system of 64 KiB, unmounted when dropped. Needs root.
#[cfg(target_os = "linux")]
struct SmallDisk(tempfile::TempDir);

#[cfg(target_os = "linux")]
impl SmallDisk {
    fn mount() -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"])
            .arg(folder.path())
            .stderr(Stdio::null())
            .status();
        mounted.is_ok_and(|status| status.success()).then_some(Self(folder))
    }
}

#[cfg(target_os = "linux")]
impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).status();
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_the_old_file() {
    let Some(disk) = SmallDisk::mount() else {
        println!("skipped: a small file system can only be mounted by root");
        return;
    };
    let path = disk.0.path().join("image.exr");
    write_atomically(&path, |file| file.write_all(b"old")).unwrap();
    let mut large = LayeredImage::new(256, 256).unwrap();
    // Numbers that do not compress.
    let noise = |i: u32| f32::from_bits(0x3f80_0000 | (i.wrapping_mul(2_654_435_769) >> 9));
    large.set_rgb(&(0..256 * 256).map(|i| [noise(i), noise(i ^ 0x5555), noise(!i)]).collect::<Vec<_>>()).unwrap();
    let error = save_image(&path, &large, 0.0).unwrap_err();
    assert!(
        matches!(&error, OutputError::Write { source, .. } if source.kind() == io::ErrorKind::StorageFull),
        "{error}"
    );
    assert!(error.to_string().contains("image.exr"));
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(disk.0.path()), ["image.exr"]);
}

#[test]
fn helper_that_writes_forever() {
    let Ok(path) = std::env::var(CHILD) else { return };
    let _ = write_atomically(Path::new(&path), |file| {
        file.write_all(&[1; 1 << 20])?;
        file.flush()?;
        say("ready");
        std::thread::sleep(Duration::from_secs(60));
        Ok(())
    });
}

#[test]
fn a_process_killed_while_writing_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("image.exr");
    save_image(&path, &image(), 0.0).unwrap();
    let (mut child, _output) = spawn("helper_that_writes_forever", path.to_str().unwrap());
    assert_eq!(names(folder.path()).len(), 2, "the half written file is beside the old one");
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(LayeredImage::read_exr(&path).unwrap(), image());
}

#[test]
fn helper_that_waits_for_interrupts() {
    if std::env::var(CHILD).is_err() {
        return;
    }
    let interrupt = Interrupt::install().unwrap();
    assert!(Interrupt::install().is_err(), "only once per process");
    say("ready");
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(60) {
        if interrupt.is_requested() {
            say("stopping");
            std::thread::sleep(Duration::from_secs(60));
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[cfg(unix)]
#[test]
fn the_first_interrupt_asks_and_the_second_ends() {
    if signals::interrupts_are_ignored() {
        return;
    }
    let (mut child, mut output) = spawn("helper_that_waits_for_interrupts", "");
    let interrupt = |child: &Child| Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(interrupt(&child).success());
    await_line(&mut output, "stopping");
    assert!(child.try_wait().unwrap().is_none(), "it goes on after the first one");
    assert!(interrupt(&child).success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

#[test]
fn images_are_saved_in_the_format_of_their_name() {
    let folder = tempfile::tempdir().unwrap();
    let (exr, png) = (folder.path().join("image.EXR"), folder.path().join("image.png"));
    save_image(&exr, &image(), 3.0).unwrap();
    save_image(&png, &image(), 0.0).unwrap();
    assert_eq!(LayeredImage::read_exr(&exr).unwrap(), image());
    assert_eq!(&fs::read(&png).unwrap()[1..4], b"PNG");
    for name in ["image", "image.jpg", ".exr"] {
        let error = ImageFormat::of(Path::new(name)).unwrap_err();
        assert!(matches!(error, OutputError::Format { .. }) && error.to_string().contains(name));
    }
    let error = save_image(&exr, &LayeredImage::new(1, 1).unwrap(), 0.0).unwrap_err();
    assert!(error.to_string().contains("image.EXR") && error.to_string().contains("no channels"), "{error}");
}

/// The next packet: its type and what follows.
fn packet(stream: &mut impl Read) -> (u8, Vec<u8>) {
    let mut length = [0; 4];
    stream.read_exact(&mut length).unwrap();
    let mut body = vec![0; u32::from_le_bytes(length) as usize - 4];
    stream.read_exact(&mut body).unwrap();
    (body.remove(0), body)
}

#[test]
fn the_display_receives_the_image() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let server = listener.local_addr().unwrap().to_string();
    let viewer = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        [packet(&mut stream), packet(&mut stream), packet(&mut stream)]
    });
    let mut display = Display::connect(&server, "test image").unwrap();
    assert!(display.is_connected() && display.is_due());
    display.update(&image()).unwrap();
    assert!(!display.is_due(), "not again within half a second");
    display.update_rows(&image(), 10..12).unwrap();

    let [create, update, rows] = viewer.join().unwrap();
    let size: Vec<u8> = [64u32, 64, 3].iter().flat_map(|number| number.to_le_bytes()).collect();
    assert_eq!(create.0, 4);
    assert!(create.1.ends_with(b"B\0G\0R\0") && create.1.windows(size.len()).any(|bytes| bytes == size));
    let data = |channel: &str, pixels: std::ops::Range<usize>| {
        image().channel(channel).unwrap()[pixels].iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>()
    };
    assert_eq!(update.0, 6);
    assert!(update.1.ends_with(&[data("B", 0..4096), data("G", 0..4096), data("R", 0..4096)].concat()));
    assert_eq!(rows.0, 6);
    assert!(rows.1.ends_with(&[data("B", 640..768), data("G", 640..768), data("R", 640..768)].concat()));
}

#[test]
fn a_display_that_goes_away_is_reported_once() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let server = listener.local_addr().unwrap().to_string();
    let mut display = Display::connect(&server, "image").unwrap();
    drop(listener.accept().unwrap());
    drop(listener);
    let errors = (0..50).filter_map(|_| display.update(&image()).err()).collect::<Vec<_>>();
    assert_eq!(errors.len(), 1);
    assert!(errors[0].to_string().starts_with(&format!("no display at {server}: ")), "{}", errors[0]);
    assert!(!display.is_connected() && !display.is_due());
    for nonsense in ["", "nowhere", "localhost:port", "127.0.0.1:99999"] {
        assert!(Display::connect(nonsense, "image").is_err(), "{nonsense}");
    }
}
