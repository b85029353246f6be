//! A possibly untrusted folder in which a program writes and removes files. An example is the
//! result of an earlier build that was unpacked from an archive.
//!
//! Such a folder may contain links at the places where the program writes and removes files. So the
//! program does not follow links inside the folder. Only the folder itself may be a link, because
//! the user names it. The program writes each file under a temporary name and then renames it to
//! the final name. If a link has the final name, the new file replaces the link. To remove an
//! entry, the program removes the entry itself, never the target of a link. Any other use of a link
//! inside the folder is an error.
//!
//! The program checks for links before each access. The checks protect against links that are
//! already in the folder, but not against a process that changes the folder at the same time.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Component, Path, PathBuf};

use crate::files::{Batch, FileInProgress, Readers, private, read_regular};

/// A folder in which a program reads, writes and removes files without following links.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let own = htex_base::files::OwnFolder::new(folder.path());
/// own.write("made/a".as_ref(), b"kept")?;
/// assert_eq!(own.read("made/a".as_ref(), 100)?, b"kept");
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct OwnFolder {
    folder: PathBuf,
    readable_by: Readers,
}

impl OwnFolder {
    /// Uses the folder at this path. The path may be a link, because the user named it.
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), readable_by: Readers::All }
    }

    /// Uses the folder at this path, as [`Self::new`] does, but makes all new files and folders
    /// private. Only this user may read new folders and files in the folder. If the folder itself
    /// does not exist yet, it is also created as a private folder.
    pub fn private(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), readable_by: Readers::User }
    }

    /// Returns the folder of a file that the user named, and the file's name in the folder.
    /// Commands use this folder for files that they write next to the named file.
    ///
    /// # Errors
    /// Returns an error if the path does not end in a name.
    pub fn of_file(path: &Path) -> io::Result<(Self, PathBuf)> {
        let no_name = || io::Error::new(ErrorKind::InvalidInput, "the path ends in no file name");
        let name = path.file_name().ok_or_else(no_name)?;
        Ok((Self::new(crate::files::folder(path)), PathBuf::from(name)))
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// Checks that no folder on the way from this folder to an entry is a link. Returns the entry's
    /// path. An empty path stands for the folder itself.
    ///
    /// # Errors
    /// Returns an error if something on the way to the entry is a link or is not a folder, or if
    /// the path leads out of this folder.
    pub fn entry_path(&self, inside: &Path) -> io::Result<PathBuf> {
        let mut path = self.folder.clone();
        let mut parts = inside.components().peekable();
        while let Some(part) = parts.next() {
            let Component::Normal(part) = part else {
                let words = format!("{} leads out of the folder", inside.display());
                return Err(io::Error::new(ErrorKind::InvalidInput, words));
            };
            path.push(part);
            if parts.peek().is_some() {
                check_folder(&path)?;
            }
        }
        Ok(path)
    }

    /// Creates a folder and the missing folders above it. Does not change an existing folder.
    ///
    /// # Errors
    /// Returns the errors of [`Self::entry_path`], an error if the entry is not a folder or is a
    /// link, and errors of the system.
    pub fn make_folder(&self, inside: &Path) -> io::Result<PathBuf> {
        self.make_itself()?;
        let mut folders: Vec<&Path> = inside.ancestors().collect();
        folders.retain(|folder| *folder != Path::new(""));
        for folder in folders.into_iter().rev() {
            let path = self.entry_path(folder)?;
            match self.create_dir(&path) {
                // The existing entry may be a link to a folder. The system would follow this link
                // for all entries below it.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => check_folder(&path)?,
                made => made?,
            }
        }
        Ok(self.folder.join(inside))
    }

    /// Opens a regular file for reading.
    ///
    /// # Errors
    /// Returns the errors of [`Self::entry_path`], an error if the entry is not a regular file or
    /// is a link, and errors of the system.
    pub fn open(&self, inside: &Path) -> io::Result<File> {
        self.open_with(inside, OpenOptions::new().read(true))
    }

    /// Opens a regular file for reading and appending.
    ///
    /// # Errors
    /// Returns the errors of [`Self::open`].
    pub fn open_to_append(&self, inside: &Path) -> io::Result<File> {
        self.open_with(inside, OpenOptions::new().read(true).append(true))
    }

    /// Creates a file and opens it for writing. The file must not exist yet. Creates missing
    /// folders above the file. For most files, use [`Self::replace`] instead, which is atomic.
    ///
    /// # Errors
    /// Returns the errors of [`Self::make_folder`], and an error if the file, or anything else of
    /// this name, exists.
    pub fn create(&self, inside: &Path) -> io::Result<File> {
        let path = self.entry(inside)?;
        let mut options = OpenOptions::new();
        if self.readable_by == Readers::User {
            private::only_user(&mut options);
        }
        // With `create_new`, the system does not follow a link.
        options.write(true).create_new(true).open(path)
    }

    /// Writes a file atomically: writes a temporary file in the same folder, flushes the temporary
    /// file to disk and renames it. Replaces a link of the same name. Creates missing folders above
    /// the file.
    ///
    /// # Errors
    /// Returns errors of `write` and of the system, the errors of [`Self::make_folder`], and an
    /// error if a folder has this name. After an error, the previous file is unchanged.
    pub fn replace(
        &self,
        inside: &Path,
        write: impl FnOnce(&mut File) -> io::Result<()>,
    ) -> io::Result<()> {
        let path = self.entry(inside)?;
        let mut unfinished = FileInProgress::in_place_of(path, self.readable_by)?;
        write(unfinished.file())?;
        unfinished.keep()
    }

    /// Writes a file as [`Self::replace`] does, but as part of a batch. The file appears under its
    /// name when [`Batch::finish`] returns, or earlier.
    ///
    /// # Errors
    /// Returns the errors of [`Self::replace`] and of [`Batch::write`].
    pub fn write_with(&self, batch: &mut Batch, inside: &Path, bytes: &[u8]) -> io::Result<()> {
        batch.write_in_place_of(self.entry(inside)?, self.readable_by, bytes)
    }

    /// Returns the path of a file for a writer that needs a path, such as a device. Creates missing
    /// folders above the file.
    ///
    /// # Errors
    /// Returns the errors of [`Self::make_folder`], and an error if a link, or anything except a
    /// regular file, has this name.
    pub fn path_to_write(&self, inside: &Path) -> io::Result<PathBuf> {
        let path = self.entry(inside)?;
        refuse_link(&path)?;
        match path.symlink_metadata() {
            Ok(is) if !is.is_file() => Err(no_file(&path)),
            _ => Ok(path),
        }
    }

    /// Reads a regular file of at most `most_bytes`.
    ///
    /// # Errors
    /// Returns the errors of [`Self::entry_path`] and [`read_regular`], and an error for a link.
    pub fn read(&self, inside: &Path, most_bytes: u64) -> io::Result<Vec<u8>> {
        let path = self.entry_path(inside)?;
        refuse_link(&path)?;
        read_regular(&path, most_bytes)
    }

    /// Opens a lock file: creates it, or opens an existing file without changing its contents.
    ///
    /// # Errors
    /// Returns the errors of [`Self::entry_path`], an error if the entry is not a regular file or
    /// is a link, and errors of the system.
    pub fn open_lock(&self, inside: &Path) -> io::Result<File> {
        let mut options = OpenOptions::new();
        self.open_with(inside, options.write(true).create(true).truncate(false))
    }

    /// Opens a regular file. Does not follow a link, and does not wait for the other end of a pipe.
    fn open_with(&self, inside: &Path, options: &mut OpenOptions) -> io::Result<File> {
        let path = self.entry_path(inside)?;
        refuse_link(&path)?;
        if path.symlink_metadata().is_ok_and(|is| !is.is_file()) {
            return Err(no_file(&path));
        }
        no_follow(options);
        options.open(&path)
    }

    /// Writes a new file in the same folder and renames it. Creates missing folders above the file.
    /// Does not flush the file to disk.
    ///
    /// # Errors
    /// Returns the errors of [`Self::make_folder`], an error if a folder has this name, and errors
    /// of the system.
    pub fn write(&self, inside: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut part = inside.as_os_str().to_owned();
        part.push(PART);
        self.write_by(Path::new(&part), inside, bytes)
    }

    /// Writes a file as [`Self::write`] does, but with the temporary name `part`, which may be
    /// anywhere in this folder.
    ///
    /// # Errors
    /// Returns the errors of [`Self::write`].
    pub fn write_by(&self, part: &Path, inside: &Path, bytes: &[u8]) -> io::Result<()> {
        let (part, path) = (self.entry(part)?, self.entry(inside)?);
        let mut file = self.create_new(&part)?;
        let written = file.write_all(bytes);
        drop(file);
        let written = written.and_then(|()| fs::rename(&part, &path));
        if written.is_err() {
            let _ = fs::remove_file(&part);
        }
        written
    }

    /// Renames a file inside this folder. Creates missing folders above the new path.
    ///
    /// # Errors
    /// Returns the errors of [`Self::write`].
    pub fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        let from = self.entry_path(from)?;
        fs::rename(from, self.entry(to)?)
    }

    /// Removes a file or a link, and then those folders above it that have become empty. A missing
    /// file is not an error.
    ///
    /// # Errors
    /// Returns the errors of [`Self::entry_path`], an error for a folder, and errors of the system.
    pub fn remove(&self, inside: &Path) -> io::Result<()> {
        let path = match self.entry_path(inside) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            path => path?,
        };
        match fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        let above = path.ancestors().skip(1);
        for folder in above.take_while(|folder| *folder != self.folder) {
            // A folder that still has files in it stays.
            if fs::remove_dir(folder).is_err() {
                break;
            }
        }
        Ok(())
    }

    /// Returns the names of the regular files in a folder, sorted by name. Returns an empty list if
    /// the folder is missing.
    ///
    /// # Errors
    /// Returns the errors of [`Self::entry_path`], an error for a link, and errors of the system.
    pub fn files(&self, inside: &Path) -> io::Result<Vec<String>> {
        let path = self.entry_path(inside)?;
        match check_folder(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            checked => checked?,
        }
        let mut names = Vec::new();
        for entry in fs::read_dir(path)? {
            let entry = entry?;
            // `file_type` describes the entry itself, so links are left out.
            if entry.file_type()?.is_file()
                && let Ok(name) = entry.file_name().into_string()
            {
                names.push(name);
            }
        }
        names.sort();
        Ok(names)
    }

    /// Removes a folder with everything in it. Links in the folder are removed and not followed. A
    /// missing folder is not an error.
    ///
    /// # Errors
    /// Returns the errors of [`Self::entry_path`], an error if the entry is not a folder or is a
    /// link, and errors of the system.
    pub fn remove_folder(&self, inside: &Path) -> io::Result<()> {
        let path = match self.entry_path(inside) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            path => path?,
        };
        match check_folder(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            Err(error) => Err(error),
            Ok(()) => fs::remove_dir_all(path),
        }
    }

    /// Creates the folder itself and the folders above it. Links are followed here, because the
    /// user named this path.
    fn make_itself(&self) -> io::Result<()> {
        match self.readable_by {
            Readers::All => fs::create_dir_all(&self.folder),
            Readers::User => private::make_folder(&self.folder),
        }
    }

    fn create_dir(&self, path: &Path) -> io::Result<()> {
        match self.readable_by {
            Readers::All => fs::create_dir(path),
            Readers::User => private::create_folder(path),
        }
    }

    /// Returns the path of a file to write, and creates the folders above it.
    fn entry(&self, inside: &Path) -> io::Result<PathBuf> {
        self.make_folder(inside.parent().unwrap_or(Path::new("")))?;
        self.entry_path(inside)
    }

    /// Creates a file for writing. If a killed process left a file of this name, removes that file
    /// first.
    fn create_new(&self, path: &Path) -> io::Result<File> {
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        if self.readable_by == Readers::User {
            private::only_user(&mut options);
        }
        let create = || options.open(path);
        match create() {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                // This removes a link itself, never its target.
                fs::remove_file(path)?;
                create()
            }
            other => other,
        }
    }
}

/// End of the name of a file that is being written.
const PART: &str = ".part";

/// Refuses a link and anything that is not a folder.
fn check_folder(path: &Path) -> io::Result<()> {
    let is = path.symlink_metadata()?;
    if is.is_dir() {
        return Ok(());
    }
    Err(if is.is_symlink() {
        link(path)
    } else {
        let words = format!("{} is in the place of a folder; remove it", path.display());
        io::Error::new(ErrorKind::NotADirectory, words)
    })
}

fn refuse_link(path: &Path) -> io::Result<()> {
    match path.symlink_metadata() {
        Ok(is) if is.is_symlink() => Err(link(path)),
        _ => Ok(()),
    }
}

fn link(path: &Path) -> io::Error {
    let words = format!(
        "{} is a symbolic link, and nothing is read or written through one here; remove it",
        path.display()
    );
    io::Error::new(ErrorKind::PermissionDenied, words)
}

fn no_file(path: &Path) -> io::Error {
    let words = format!("{} is no regular file; remove it", path.display());
    io::Error::new(ErrorKind::InvalidInput, words)
}

#[cfg(unix)]
fn no_follow(options: &mut OpenOptions) {
    use std::os::unix::fs::OpenOptionsExt;
    // The checks before may be outdated when the file is opened. With these flags, the system
    // itself refuses a link and does not wait for a pipe.
    let flags = rustix::fs::OFlags::NOFOLLOW | rustix::fs::OFlags::NONBLOCK;
    options.custom_flags(flags.bits().cast_signed());
}

#[cfg(not(unix))]
fn no_follow(_: &mut OpenOptions) {}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn files_of_a_private_folder_are_for_this_user_alone() {
        use std::os::unix::fs::PermissionsExt;
        let place = tempfile::tempdir().unwrap();
        let own = OwnFolder::private(&place.path().join("takes"));
        own.write(Path::new("take.csv"), b"1").unwrap();
        let mode = fs::metadata(place.path().join("takes/take.csv")).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
    }

    /// Links of every kind are placed everywhere. Nothing outside the folder is read, written or
    /// removed.
    #[test]
    fn nothing_is_followed() -> Result<(), Box<dyn std::error::Error>> {
        let (outside, inside) = (tempfile::tempdir()?, tempfile::tempdir()?);
        let victim = outside.path().join("victim");
        fs::write(&victim, "precious")?;
        symlink(outside.path(), inside.path().join("folder"))?;
        symlink(&victim, inside.path().join("file"))?;
        symlink(&victim, inside.path().join("new.part"))?;
        let own = OwnFolder::new(inside.path());
        let mut batch = Batch::default();
        for name in ["folder/victim", "folder/new", "folder/deep/new", "../victim", "/victim"] {
            let name = Path::new(name);
            assert!(own.write(name, b"x").is_err(), "{}", name.display());
            assert!(own.read(name, 100).is_err() && own.open_lock(name).is_err());
            assert!(own.open(name).is_err() && own.open_to_append(name).is_err());
            assert!(own.create(name).is_err() && own.path_to_write(name).is_err());
            assert!(own.replace(name, |_| Ok(())).is_err());
            assert!(own.write_with(&mut batch, name, b"x").is_err());
            assert!(own.remove(name).is_err(), "{}", name.display());
        }
        let folder = Path::new("folder");
        assert!(own.files(folder).is_err() && own.remove_folder(folder).is_err());
        assert!(own.make_folder(folder).is_err());
        let file = Path::new("file");
        assert!(own.read(file, 100).is_err() && own.open_lock(file).is_err());
        assert!(own.open(file).is_err() && own.open_to_append(file).is_err());
        assert!(own.create(file).is_err() && own.path_to_write(file).is_err());
        // A link in the place of a result, or of its partial file, is replaced.
        own.write("new".as_ref(), b"x")?;
        own.write(file, b"x")?;
        assert!(inside.path().join("file").symlink_metadata()?.is_file());
        for by_batch in [false, true] {
            own.remove(file)?;
            symlink(&victim, inside.path().join(file))?;
            if by_batch {
                own.write_with(&mut batch, file, b"y")?
            } else {
                own.replace(file, |made| made.write_all(b"y"))?
            }
            std::mem::take(&mut batch).finish()?;
            assert_eq!(own.read(file, 1)?, b"y");
        }
        own.remove(file)?;
        assert_eq!(fs::read(&victim)?, b"precious");
        assert_eq!(fs::read_dir(outside.path())?.count(), 1);
        // The user names the folder itself, so it may be a link.
        let named = outside.path().join("named");
        symlink(inside.path(), &named)?;
        OwnFolder::new(&named).write("a/b".as_ref(), b"x")?;
        assert_eq!(OwnFolder::new(inside.path()).files("a".as_ref())?, ["b"]);
        Ok(())
    }
}
