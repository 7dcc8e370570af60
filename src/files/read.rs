//! Reads files that others may have changed: no more than the expected size, no pipes or devices, and errors that name the file.

use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// Most bytes of a study file: when parsed, a text takes a hundred times as much memory.
pub const STUDY_BYTES: u64 = 4 << 20;
/// Most bytes of a JSON file of a result, of a table of bins, cells or vertices, and of a picture.
pub const RESULT_BYTES: u64 = 64 << 20;
/// Most bytes of a row of a table of designs.
pub const ROW_BYTES: u64 = 1 << 20;

/// Opens a file for reading: a regular file, or one that the shell passes. A named pipe could be waited for endlessly, and a device could
/// give endless bytes.
///
/// # Errors
/// Those of the file system; one that says what it is if it is not a file.
pub fn open(path: &Path) -> io::Result<File> {
    let metadata = fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    // As shells pass `<(...)` and standard input.
    let handed_over = ["/dev/fd", "/dev/stdin", "/proc/self/fd"].iter().any(|it| path.starts_with(it));
    if !metadata.is_file() && !handed_over {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a pipe or a device; name a file"));
    }
    File::open(path)
}

/// The bytes of a file of at most `most` bytes; `remedy` is what to do about a larger one.
///
/// # Errors
/// [`Error::Io`] that names the file.
pub fn read_bytes(path: &Path, most: u64, remedy: &str) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path).and_then(|file| file.take(most + 1).read_to_end(&mut bytes)).map_err(Error::io(path))?;
    if bytes.len() as u64 > most {
        let size = if most >= 1 << 20 { format!("{} MiB", most >> 20) } else { format!("{most} bytes") };
        return Err(Error::io(path)(io::Error::new(io::ErrorKind::FileTooLarge, format!("it has more than {size}; {remedy}"))));
    }
    Ok(bytes)
}

/// The same as text.
///
/// # Errors
/// [`Error::Io`] that names the file.
pub fn read_text(path: &Path, most: u64, remedy: &str) -> Result<String> {
    let not_text = |_| Error::io(path)(io::Error::new(io::ErrorKind::InvalidData, "it is not UTF-8 text"));
    String::from_utf8(read_bytes(path, most, remedy)?).map_err(not_text)
}

/// Reads as long as no line is longer than `most` bytes: a table may be larger than the memory, but a row must not be. A quote that its line
/// does not close would make a row of many lines, and is refused too.
#[derive(Debug)]
pub struct ShortLines<R> {
    inner: R,
    most: u64,
    /// Bytes of the line so far.
    line: u64,
    /// Is a quote open in it?
    quoted: bool,
}

impl<R: Read> ShortLines<R> {
    /// Reads from `inner`.
    pub fn new(inner: R, most: u64) -> Self {
        Self { inner, most, line: 0, quoted: false }
    }
}

impl<R: Read> Read for ShortLines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(buffer)?;
        let (mut first, bytes) = (true, &buffer[..read]);
        for line in bytes.split(|&byte| byte == b'\n') {
            if !first && self.quoted {
                return Err(io::Error::new(io::ErrorKind::InvalidData, "a line has a quote that is not closed"));
            }
            self.line = if first { self.line } else { 0 } + line.len() as u64;
            self.quoted ^= line.iter().filter(|&&byte| byte == b'"').count() % 2 == 1;
            first = false;
            if self.line > self.most {
                return Err(io::Error::new(io::ErrorKind::InvalidData, format!("a line has more than {} bytes", self.most)));
            }
        }
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_large_no_text_or_no_file_is_refused_by_name() {
        let folder = tempfile::tempdir().expect("there is room");
        let at = |name: &str| folder.path().join(name);
        fs::write(at("good"), "four").expect("it can be written");
        fs::write(at("bytes"), b"\xff\xfe").expect("it can be written");
        assert_eq!(read_text(&at("good"), 4, "").expect("it is short enough"), "four");
        let refused = |name: &str, most: u64| read_text(&at(name), most, "split it").expect_err(name).to_string();
        assert!(refused("good", 3).ends_with("good: it has more than 3 bytes; split it"), "{}", refused("good", 3));
        assert!(refused("bytes", 4).ends_with("bytes: it is not UTF-8 text"), "{}", refused("bytes", 4));
        assert!(refused("", 4).contains("is a directory"), "{}", refused("", 4));
        assert!(refused("nothing", 4).contains("nothing: "), "{}", refused("nothing", 4));
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_not_read_and_what_a_shell_hands_over_is_read_as_far_as_allowed() {
        let refused = read_bytes(Path::new("/dev/zero"), 4, "").expect_err("it is a device").to_string();
        assert_eq!(refused, "/dev/zero: it is a pipe or a device; name a file");
        let file = File::open("/dev/zero").expect("it is there");
        let number = std::os::fd::AsRawFd::as_raw_fd(&file);
        let refused = read_bytes(Path::new(&format!("/dev/fd/{number}")), 4, "").expect_err("it has no end").to_string();
        assert!(refused.contains("more than 4 bytes"), "{refused}");
    }

    #[test]
    fn short_lines_pass_whatever_the_pieces_and_a_long_one_does_not() {
        struct Pieces<'a>(&'a [u8], usize);
        impl Read for Pieces<'_> {
            fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                let size = self.1.min(self.0.len()).min(buffer.len());
                buffer[..size].copy_from_slice(&self.0[..size]);
                self.0 = &self.0[size..];
                Ok(size)
            }
        }
        for pieces in 1..9 {
            let read = |text: &str| ShortLines::new(Pieces(text.as_bytes(), pieces), 4).read_to_string(&mut String::new());
            assert_eq!(read("four\nfour\n\n4444").expect("no line is longer"), 15);
            assert!(read("four\nfives\n").is_err() && read("fives").is_err(), "in pieces of {pieces}");
            assert_eq!(read("\",\"\nno\n").expect("its quotes are closed"), 7);
            assert!(read("a,\"b\n\"c\"\n").is_err(), "in pieces of {pieces}");
        }
    }
}
