//! The files a command writes: all aside first, put in place together at the end, so that a
//! failure or an interrupt leaves nothing half written.

use super::failure::Failure;
use super::interrupt;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Files that wait to be put in place. Those not committed are removed.
#[derive(Default)]
pub(super) struct Outputs {
    staged: Vec<Staged>,
}

/// One file.
struct Staged {
    /// What the user named, for messages.
    named: PathBuf,
    /// What is replaced: the target, if a link was named.
    target: PathBuf,
    content: Content,
}

enum Content {
    /// Written beside the target.
    Aside(tempfile::TempPath),
    /// For a pipe or a device, which cannot be replaced: written when committed.
    Held(Vec<u8>),
}

impl Drop for Staged {
    fn drop(&mut self) {
        if let Content::Aside(path) = &self.content {
            interrupt::forget(path);
        }
    }
}

impl Outputs {
    /// Writes a file aside, in the folder where it will be.
    pub fn stage(
        &mut self,
        path: &Path,
        write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<(), Failure> {
        let staged = Self::write_aside(path, write);
        self.staged.push(staged.map_err(|e| Failure::writing(path, e))?);
        Ok(())
    }

    fn write_aside(
        path: &Path,
        write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> std::io::Result<Staged> {
        let target = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let old = std::fs::metadata(&target).ok();
        let named = path.to_owned();
        if old.as_ref().is_some_and(|m| m.is_dir()) {
            return Err(std::io::Error::other("it is a folder"));
        }
        if old.as_ref().is_some_and(|m| !m.is_file()) {
            let mut bytes = Vec::new();
            write(&mut bytes)?;
            return Ok(Staged { named, target, content: Content::Held(bytes) });
        }
        let folder = target.parent().filter(|f| !f.as_os_str().is_empty());
        let mut builder = tempfile::Builder::new();
        builder.prefix(".complete-mesh-").suffix(".tmp");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // Less the umask, like any new file; alone, `tempfile` makes it private.
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        let file = builder.tempfile_in(folder.unwrap_or(Path::new(".")))?;
        interrupt::remember(file.path());
        let (mut file, aside) = file.into_parts();
        // From here on the drop of `staged` forgets the file.
        let staged = Staged { named, target, content: Content::Aside(aside) };
        let mut buffered = std::io::BufWriter::with_capacity(1 << 16, &mut file);
        write(&mut buffered)?;
        buffered.flush()?;
        drop(buffered);
        if let Some(old) = old {
            file.set_permissions(old.permissions())?;
        }
        file.sync_all()?;
        Ok(staged)
    }

    /// Puts all files in place, in the order they were staged.
    pub fn commit(mut self) -> Result<(), Failure> {
        for mut staged in self.staged.drain(..) {
            let done = match std::mem::replace(&mut staged.content, Content::Held(Vec::new())) {
                Content::Aside(aside) => {
                    interrupt::forget(&aside);
                    aside.persist(&staged.target).map_err(|e| e.error)
                }
                Content::Held(bytes) => std::fs::File::options()
                    .write(true)
                    .open(&staged.target)
                    .and_then(|mut file| file.write_all(&bytes)),
            };
            done.map_err(|e| Failure::writing(&staged.named, e))?;
        }
        Ok(())
    }
}

/// Whether two paths name one file, as far as can be told before they exist.
pub(super) fn same_file(a: &Path, b: &Path) -> bool {
    let settle = |p: &Path| {
        std::fs::canonicalize(p).unwrap_or_else(|_| {
            let folder = p.parent().filter(|f| !f.as_os_str().is_empty());
            let folder = std::fs::canonicalize(folder.unwrap_or(Path::new(".")));
            match (folder, p.file_name()) {
                (Ok(folder), Some(name)) => folder.join(name),
                _ => p.to_owned(),
            }
        })
    };
    a == b || settle(a) == settle(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_there_before_the_commit_and_everything_after() {
        let folder = tempfile::tempdir().unwrap();
        let (a, b) = (folder.path().join("a"), folder.path().join("b"));
        std::fs::write(&a, "old").unwrap();
        let mut outputs = Outputs::default();
        outputs.stage(&a, |w| w.write_all(b"new")).unwrap();
        outputs.stage(&b, |w| w.write_all(b"other")).unwrap();
        assert_eq!(std::fs::read(&a).unwrap(), b"old");
        assert!(!b.exists());
        outputs.commit().unwrap();
        assert_eq!(std::fs::read(&a).unwrap(), b"new");
        assert_eq!(std::fs::read(&b).unwrap(), b"other");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "no aside file is left");
    }

    #[test]
    fn a_failure_leaves_no_trace() {
        let folder = tempfile::tempdir().unwrap();
        let a = folder.path().join("a");
        std::fs::write(&a, "old").unwrap();
        let mut outputs = Outputs::default();
        outputs.stage(&a, |w| w.write_all(b"new")).unwrap();
        let failed = outputs.stage(&folder.path().join("b"), |w| {
            w.write_all(b"half")?;
            Err(std::io::Error::other("full"))
        });
        assert_eq!(failed.unwrap_err().code(), 3);
        drop(outputs);
        assert_eq!(std::fs::read(&a).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_stay() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        std::fs::write(&file, "old").unwrap();
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        assert!(same_file(&file, &link));
        let mut outputs = Outputs::default();
        outputs.stage(&link, |w| w.write_all(b"new")).unwrap();
        outputs.commit().unwrap();
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        assert_eq!(std::fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
    }

    #[test]
    fn files_that_do_not_exist_yet_are_compared_by_their_folder() {
        let folder = tempfile::tempdir().unwrap();
        let plain = folder.path().join("x.ply");
        assert!(same_file(&plain, &folder.path().join(".").join("x.ply")));
        assert!(!same_file(&plain, &folder.path().join("y.ply")));
    }
}
