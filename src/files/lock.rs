//! A lock file beside what it protects: it is locked, says which process holds it, and is removed when no process needs it.
//!
//! If the file were removed while another process waits for it, two processes would hold the lock: the one that waited, and one that
//! makes the file anew. So only a process that holds the lock alone removes it, and a process that gets a lock checks that the file still
//! has its name.

use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How often, and after which pause, a lock is tried again before it counts as held by another process.
const ATTEMPTS: u32 = 20;
const PAUSE: Duration = Duration::from_millis(10);
/// How often in succession the file may be found removed before the file system counts as broken.
const MOST_GONE: u32 = 10_000;
/// Beginning of the first line of a lock.
const MARK: &str = "beltspace";
/// Most bytes of that line that are read.
const LINE: u64 = 1000;

/// A lock that this process holds until it is dropped.
#[derive(Debug)]
pub struct Lock {
    file: File,
    path: PathBuf,
}

/// The outcome of asking for a lock.
#[derive(Debug)]
pub enum Taken {
    /// This process holds it.
    Held(Lock),
    /// Another process holds it: which, as far as that is known.
    Busy(String),
}

impl Lock {
    /// Takes the lock at `path` for this process alone. `task` is what others are told meanwhile.
    ///
    /// # Errors
    /// Those of the file system; a file of that name that is not a lock.
    pub fn alone(path: &Path, task: &str) -> io::Result<Taken> {
        Self::take(path, task, File::try_lock)
    }

    /// Takes the lock at `path` together with other processes that only read what it protects.
    ///
    /// # Errors
    /// As [`Lock::alone`].
    pub fn shared(path: &Path, task: &str) -> io::Result<Taken> {
        Self::take(path, task, File::try_lock_shared)
    }

    /// Takes an existing lock together with other readers, without writing anything; `None` if there is none.
    ///
    /// # Errors
    /// As [`Lock::alone`].
    pub fn shared_if_there(path: &Path) -> io::Result<Option<Taken>> {
        let file = match File::open(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            file => file?,
        };
        let taken = try_for_a_while(&file, File::try_lock_shared)?;
        Ok(Some(if taken { Taken::Held(Self { file, path: path.to_owned() }) } else { Taken::Busy(holder(&file)) }))
    }

    fn take(path: &Path, task: &str, lock: fn(&File) -> Result<(), TryLockError>) -> io::Result<Taken> {
        for _ in 0..MOST_GONE {
            // If this were a link, this program would write into the file that it points to.
            if fs::symlink_metadata(path).is_ok_and(|it| !it.is_file()) {
                return Err(not_a_lock());
            }
            let (file, writable) = open(path)?;
            if !is_at(&file, path) {
                continue;
            }
            if !is_a_lock(&file)? {
                return Err(not_a_lock());
            }
            if !try_for_a_while(&file, lock)? {
                return Ok(Taken::Busy(holder(&file)));
            }
            // The holder before has removed it: another file is the lock now, or will be.
            if !is_at(&file, path) {
                continue;
            }
            let mut held = Self { file, path: path.to_owned() };
            if writable {
                held.say(task)?;
            }
            return Ok(Taken::Held(held));
        }
        Err(io::Error::other("the lock file is a different one each time it is checked"))
    }

    /// Writes into the file which process holds it.
    fn say(&mut self, task: &str) -> io::Result<()> {
        #[cfg(feature = "cli")]
        let host = gethostname::gethostname();
        // Most systems have the name here; asking the system for it would need another package.
        #[cfg(not(feature = "cli"))]
        let host = std::env::var_os("HOSTNAME").unwrap_or_else(|| "this machine".into());
        let line = format!("{MARK}: process {} on {}: {task}\n", std::process::id(), host.to_string_lossy());
        self.file.seek(io::SeekFrom::Start(0))?;
        // A second reader writes its line over that of the first. Whoever looks meanwhile must find a line, so the file is never emptied.
        self.file.write_all(line.as_bytes())?;
        self.file.set_len(line.len() as u64)
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Other readers still need it. On systems where an open file cannot be compared with its name, it stays.
        if cfg!(unix) && self.file.try_lock().is_ok() && is_at(&self.file, &self.path) {
            // A lock file that stays does no harm.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Opens a lock file, and makes it if there is none; returns whether it can be written to. The file that a killed run of another user
/// left can be locked without being written to.
fn open(path: &Path) -> io::Result<(File, bool)> {
    match File::options().read(true).write(true).create(true).truncate(false).open(path) {
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => File::open(path).map(|file| (file, false)).map_err(|_| error),
        file => file.map(|file| (file, true)),
    }
}

fn not_a_lock() -> io::Error {
    io::Error::other("this is not a lock of beltspace; move it away")
}

fn try_for_a_while(file: &File, lock: fn(&File) -> Result<(), TryLockError>) -> io::Result<bool> {
    // A process that is just starting another program still shares its files, and so a released lock, for a moment.
    let mut attempts = 0..ATTEMPTS;
    loop {
        match lock(file) {
            Ok(()) => return Ok(true),
            Err(TryLockError::WouldBlock) if attempts.next().is_some() => std::thread::sleep(PAUSE),
            Err(TryLockError::WouldBlock) => return Ok(false),
            Err(TryLockError::Error(error)) => return Err(error),
        }
    }
}

/// Does this open file still have this name? The name is opened again rather than queried, because network file systems ask the server
/// only then.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let number = |file: &File| file.metadata().map(|it| (it.dev(), it.ino()));
    match (number(file), File::open(path).and_then(|it| number(&it))) {
        (Ok(own), Ok(there)) => own == there && fs::symlink_metadata(path).is_ok_and(|it| it.is_file()),
        _ => false,
    }
}

/// On this system the file is never removed.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    true
}

/// The beginning of a file, as much as a lock can hold.
fn beginning(mut file: &File) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.seek(io::SeekFrom::Start(0))?;
    file.take(LINE).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A lock is empty until its first holder has written into it. Only what is read decides: a length asked for earlier may have changed by
/// then, since other processes write into the file too.
fn is_a_lock(file: &File) -> io::Result<bool> {
    // On systems where a lock keeps others from reading, nothing is known of a file that is held.
    if cfg!(not(unix)) {
        return Ok(true);
    }
    let bytes = beginning(file)?;
    Ok(bytes.is_empty() || bytes.starts_with(MARK.as_bytes()))
}

/// Which process holds a lock, and for how long: `process 12 on host, for 3 s: beltspace sweep study.toml`.
fn holder(file: &File) -> String {
    // Where a lock keeps others from reading, the process cannot be named.
    let text = String::from_utf8_lossy(&beginning(file).unwrap_or_default()).into_owned();
    let line = text.lines().next().unwrap_or_default();
    let since = file.metadata().and_then(|it| it.modified()).ok().and_then(|it| it.elapsed().ok());
    let Some((who, what)) = line.strip_prefix(MARK).and_then(|it| it.strip_prefix(": ")).and_then(|it| it.split_once(": ")) else {
        return "it is not known which".to_owned();
    };
    let since = since.map_or(String::new(), |it| format!(", for {}", for_people(it)));
    // Any program may have written the file.
    let plain =
        |text: &str| text.chars().flat_map(|c| if c.is_control() { c.escape_default().collect() } else { vec![c] }).collect::<String>();
    format!("{}{since}: {}", plain(who), plain(what))
}

fn for_people(span: Duration) -> String {
    match span.as_secs() {
        seconds @ 0..120 => format!("{seconds} s"),
        seconds @ 120..7200 => format!("{} min", seconds / 60),
        seconds => format!("{} h", seconds / 3600),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU32, Ordering};

    fn folder() -> tempfile::TempDir {
        tempfile::tempdir().expect("there is room")
    }

    #[test]
    fn a_lock_has_one_holder_who_says_what_it_does() {
        let folder = folder();
        let path = folder.path().join(".out.beltspace-lock");
        let Ok(Taken::Held(first)) = Lock::alone(&path, "beltspace sweep a.toml") else { panic!("it is free") };
        for second in [Lock::alone(&path, "another"), Lock::shared(&path, "another")] {
            let Ok(Taken::Busy(who)) = second else { panic!("it is held") };
            let own = format!("process {} on ", std::process::id());
            assert!(who.starts_with(&own) && who.ends_with(": beltspace sweep a.toml"), "{who}");
        }
        drop(first);
        assert!(!path.exists() || cfg!(not(unix)));
        let Ok(Taken::Held(first)) = Lock::shared(&path, "beltspace report out") else { panic!("it is free again") };
        let Ok(Taken::Held(second)) = Lock::shared(&path, "beltspace report out") else { panic!("readers share it") };
        assert!(matches!(Lock::alone(&path, "beltspace sweep"), Ok(Taken::Busy(_))));
        drop(first);
        assert!(matches!(Lock::alone(&path, "beltspace sweep"), Ok(Taken::Busy(_))), "one still reads");
        drop(second);
        assert!(matches!(Lock::alone(&path, "beltspace sweep"), Ok(Taken::Held(_))));
    }

    #[test]
    fn many_threads_never_hold_it_together() {
        let folder = folder();
        let path = folder.path().join("lock");
        let (inside, rounds) = (AtomicU32::new(0), AtomicU32::new(0));
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    while rounds.load(Ordering::SeqCst) < 400 {
                        let Taken::Held(lock) = Lock::alone(&path, "turn").expect("the folder is there") else { continue };
                        assert_eq!(inside.fetch_add(1, Ordering::SeqCst), 0, "two hold it");
                        std::thread::yield_now();
                        inside.fetch_sub(1, Ordering::SeqCst);
                        rounds.fetch_add(1, Ordering::SeqCst);
                        drop(lock);
                    }
                });
            }
        });
    }

    /// Each reader writes its own line over that of the reader before.
    #[test]
    fn a_lock_is_one_while_readers_write_into_it() {
        let folder = folder();
        let path = folder.path().join("lock");
        let Ok(Taken::Held(_first)) = Lock::shared(&path, "a reader whose line is longer than that of the next") else {
            panic!("it is free")
        };
        std::thread::scope(|scope| {
            let readers = scope.spawn(|| {
                for round in 0..3000 {
                    let Ok(Taken::Held(_)) = Lock::shared(&path, ["short", "a longer task than before"][round % 2]) else {
                        panic!("readers share it")
                    };
                }
            });
            let file = File::open(&path).expect("it is there");
            while !readers.is_finished() {
                assert!(is_a_lock(&file).expect("it can be read"));
                assert_ne!(holder(&file), "it is not known which");
            }
        });
        let text = fs::read_to_string(&path).expect("it is there");
        assert_eq!(text.lines().count(), 1, "{text}");
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_lock_is_left_alone() {
        let folder = folder();
        let [note, link, target] = ["note", "link", "target"].map(|name| folder.path().join(name));
        fs::write(&note, "groceries").expect("it can be written");
        std::os::unix::fs::symlink(&target, &link).expect("links can be made");
        for path in [&note, &link] {
            assert!(Lock::alone(path, "turn").expect_err("it is no lock").to_string().contains("not a lock of beltspace"));
        }
        assert_eq!(fs::read(&note).expect("it is there"), b"groceries");
        assert!(!target.exists());
    }
}
