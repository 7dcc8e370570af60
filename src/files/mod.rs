//! Writes files so that nothing is lost: there is always the whole old file or the whole new one, and files that this program did not
//! write are left alone. Reads files only if they can be what is expected.

mod claim;
mod lock;
mod read;

pub use claim::{Claim, Reading};
pub use lock::{Lock, Taken};
pub use read::{RESULT_BYTES, ROW_BYTES, STUDY_BYTES, ShortLines, open, read_bytes, read_text};

use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// Extension of a file that is being written.
const WRITING: &str = ".writing";
/// How many bytes at the beginning of a file are read to find out what wrote it.
const HEAD: u64 = 4096;

/// Writes a file so that at any moment there is either the whole old one or the whole new one, even if others write it too.
///
/// # Errors
/// [`Error::Io`]; the old file is then untouched.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    replace_with(path, |file| file.write_all(bytes))
}

/// The same with the bytes that `write` writes.
///
/// # Errors
/// [`Error::Io`]; the old file is then untouched.
pub fn replace_with(path: &Path, write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    let name = path.file_name().ok_or_else(|| Error::Request(format!("{}: this is not the name of a file", path.display())))?;
    // A failure leaves nothing behind: the temporary file is removed when it is dropped.
    let done = || -> std::io::Result<()> {
        let mut file = temporary(parent(path), &name.to_string_lossy())?;
        let mut out = std::io::BufWriter::new(file.as_file_mut());
        write(&mut out)?;
        out.flush()?;
        drop(out);
        file.as_file().sync_all()?;
        file.persist(path)?;
        Ok(())
    };
    done().map_err(|error| Error::io(path)(without_temporary_name(error, path)))
}

/// The error without the name of the temporary file, which nobody has given.
fn without_temporary_name(error: std::io::Error, path: &Path) -> std::io::Error {
    let folder = parent(path);
    if error.kind() == std::io::ErrorKind::NotFound && !folder.is_dir() {
        return std::io::Error::new(error.kind(), no_folder(folder));
    }
    let inner = error.get_ref().and_then(std::error::Error::source).and_then(|it| it.downcast_ref::<std::io::Error>());
    inner.and_then(std::io::Error::raw_os_error).map_or(error, std::io::Error::from_raw_os_error)
}

fn no_folder(folder: &Path) -> String {
    format!("there is no directory {}; make it, or name another file", folder.display())
}

/// Refuses the name of a file in a directory that is not there, before any work is done for it.
///
/// # Errors
/// [`Error::Request`] that names both.
pub fn refuse_without_folder(path: &Path) -> Result<()> {
    let folder = parent(path);
    if folder.is_dir() { Ok(()) } else { Err(Error::Request(format!("{}: {}", path.display(), no_folder(folder)))) }
}

/// A new temporary file beside the one of that name, with a unique name.
fn temporary(folder: &Path, name: &str) -> std::io::Result<NamedTempFile> {
    let prefix = format!(".{name}.");
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(WRITING);
    // With the permissions of any other new file; by default only its owner could read it.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// A unique temporary name for what will become `name`.
pub fn writing_name(name: &str, number: u32) -> String {
    format!(".{name}.{:06}{WRITING}", number % 1_000_000)
}

/// The final name of a file with this temporary name; `None` if it is not a temporary name.
pub fn was_to_become(name: &str) -> Option<&str> {
    let (stem, random) = name.strip_prefix('.')?.strip_suffix(WRITING)?.rsplit_once('.')?;
    (random.len() == 6 && random.bytes().all(|it| it.is_ascii_alphanumeric())).then_some(stem)
}

/// The parent directory of a path.
pub fn parent(path: &Path) -> &Path {
    path.parent().filter(|it| !it.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Is this a regular file, and not a link to one?
pub fn is_regular(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|it| it.is_file())
}

/// Does anything have this name, even a broken link?
pub fn is_there(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// Removes a file, unless it is gone already.
///
/// # Errors
/// [`Error::Io`].
pub fn remove_if_there(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Error::io(path)(error)),
        _ => Ok(()),
    }
}

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// Why not, in words.
pub fn read_at_most(path: &Path, most: u64) -> std::result::Result<Vec<u8>, String> {
    if !is_regular(path) {
        return Err("it is not a regular file".to_owned());
    }
    let large = || Err(format!("it has more than {most} bytes"));
    if fs::metadata(path).is_ok_and(|it| it.len() > most) {
        return large();
    }
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(most + 1).read_to_end(&mut bytes));
    match read {
        Err(error) => Err(error.to_string()),
        Ok(_) if bytes.len() as u64 > most => large(),
        Ok(_) => Ok(bytes),
    }
}

/// What a user can do about a file that is in the way.
pub const MOVE: &str = "move it away, or name another";

/// Refuses to replace what this program did not write: `is_own` decides from the beginning of the file. An empty file may be replaced.
/// `remedy` is what the user can do instead.
///
/// # Errors
/// [`Error::Request`] that names the file.
pub fn refuse_foreign(path: &Path, remedy: &str, is_own: impl Fn(&str) -> bool) -> Result<()> {
    let refuse = |problem: &str| Err(Error::Request(format!("{}: {problem}", path.display())));
    if !is_there(path) {
        return Ok(());
    }
    if path.is_dir() {
        return refuse("it is a directory; name a file");
    }
    if !is_regular(path) {
        return refuse("it is a link or a device; name a file");
    }
    let mut head = Vec::new();
    File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head)).map_err(Error::io(path))?;
    if head.is_empty() || is_own(&String::from_utf8_lossy(&head)) {
        return Ok(());
    }
    refuse(&format!("a file is there that this program did not write; {remedy}"))
}

/// Directories that were made for a purpose, to be removed if they are still empty in the end.
#[derive(Debug, Default)]
pub struct Made(Vec<PathBuf>);

impl Made {
    /// Makes a directory and its parents.
    ///
    /// # Errors
    /// Those of the file system; directories made before stay in `self`.
    pub fn make(&mut self, folder: &Path) -> std::io::Result<()> {
        let missing: Vec<_> = folder.ancestors().take_while(|it| !it.as_os_str().is_empty() && !it.exists()).collect();
        for folder in missing.into_iter().rev() {
            match fs::create_dir(folder) {
                Ok(()) => self.0.push(folder.to_owned()),
                // Another process was faster.
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists && folder.is_dir() => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Removes those that are still empty.
    pub fn take_back(&mut self) {
        for folder in self.0.drain(..).rev() {
            // Those that are in use by now are not empty and stay.
            let _ = fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_or_not_at_all() {
        let folder = tempfile::tempdir().expect("there is room");
        let path = folder.path().join("front.csv");
        replace(&path, b"old").expect("it can be written");
        let failed = replace_with(&path, |file| {
            file.write_all(b"half of the n")?;
            Err(std::io::Error::other("the disk is full"))
        });
        assert!(failed.expect_err("it failed").to_string().contains("front.csv: the disk is full"));
        assert_eq!(fs::read(&path).expect("it is there"), b"old");
        assert_eq!(folder.path().read_dir().expect("it can be listed").count(), 1, "nothing is left behind");
        replace(&path, b"new").expect("it can be written");
        assert_eq!(fs::read(&path).expect("it is there"), b"new");
        let nowhere = folder.path().join("none/front.csv");
        let told = replace(&nowhere, b"new").expect_err("there is no such directory").to_string();
        assert_eq!(
            told,
            format!("{}: there is no directory {}; make it, or name another file", nowhere.display(), folder.path().join("none").display())
        );
    }

    #[test]
    fn a_temporary_name_says_what_it_was_to_become() {
        let folder = tempfile::tempdir().expect("there is room");
        let file = temporary(folder.path(), "front.csv").expect("it can be made");
        let name = file.path().file_name().expect("it has one").to_string_lossy().into_owned();
        assert_eq!(was_to_become(&name), Some("front.csv"));
        for other in ["front.csv", ".front.csv", ".front.csv.writing", ".front.csv.abc-ef.writing", "front.csv.abcdef.writing", ".x.abcdef"]
        {
            assert_eq!(was_to_become(other), None, "{other}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn what_others_wrote_is_refused() {
        let folder = tempfile::tempdir().expect("there is room");
        let own = |text: &str| text.starts_with("own");
        let at = |name: &str| folder.path().join(name);
        fs::write(at("own"), "own file").expect("it can be written");
        fs::write(at("empty"), "").expect("it can be written");
        fs::write(at("foreign"), "thesis").expect("it can be written");
        std::os::unix::fs::symlink(at("own"), at("link")).expect("links can be made");
        std::os::unix::fs::symlink(at("nowhere"), at("dangling")).expect("links can be made");
        for good in ["own", "empty", "new"] {
            refuse_foreign(&at(good), MOVE, own).expect(good);
        }
        for (bad, why) in [("foreign", "did not write"), ("link", "a link"), ("dangling", "a link"), (".", "a directory")] {
            let refused = refuse_foreign(&at(bad), MOVE, own).expect_err(bad).to_string();
            assert!(refused.contains(why) && (why != "did not write" || refused.ends_with(MOVE)), "{refused}");
        }
    }

    #[test]
    fn directories_are_taken_back_while_they_are_empty() {
        let folder = tempfile::tempdir().expect("there is room");
        let deep = folder.path().join("a/b/c");
        let mut made = Made::default();
        made.make(&deep).expect("they can be made");
        fs::write(folder.path().join("a/note"), "mine").expect("it can be written");
        made.take_back();
        assert!(!folder.path().join("a/b").exists() && folder.path().join("a/note").exists());
    }
}
