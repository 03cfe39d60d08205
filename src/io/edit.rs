//! Changing a file's bytes in place, and saving them whole or not at all.

use super::error::IoError;
use std::io::Write;
use std::ops::Range;
use std::path::Path;

/// Replaces the bytes `at` by `with`; an empty range inserts.
#[derive(Debug)]
pub(super) struct Edit {
    pub at: Range<usize>,
    pub with: Vec<u8>,
}

/// Makes all edits, which neither overlap nor make anything shorter, without a second copy.
/// Insertions at the same byte stay in their order.
pub(super) fn splice(bytes: &mut Vec<u8>, mut edits: Vec<Edit>) {
    edits.sort_by_key(|e| e.at.start);
    let growth: usize = edits.iter().map(|e| e.with.len() - e.at.len()).sum();
    let mut tail = bytes.len();
    bytes.reserve_exact(growth);
    bytes.resize(tail + growth, 0);
    // From the back, so that nothing is overwritten before it has moved.
    let mut to = bytes.len();
    for edit in edits.iter().rev() {
        to -= tail - edit.at.end;
        bytes.copy_within(edit.at.end..tail, to);
        to -= edit.with.len();
        bytes[to..to + edit.with.len()].copy_from_slice(&edit.with);
        tail = edit.at.start;
    }
}

/// Writes a file aside, in the same folder, and puts it in place when all of it is on the disk:
/// there is the old file or the new one, never half of one.
pub(super) fn save(path: &Path, bytes: &[u8]) -> Result<(), IoError> {
    let save = || -> std::io::Result<()> {
        // A link stays one; what it points to is replaced.
        let target = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let old = std::fs::metadata(&target).ok();
        if old.as_ref().is_some_and(|m| !m.is_file() && !m.is_dir()) {
            // A pipe or a device cannot be replaced.
            return std::fs::File::options().write(true).open(&target)?.write_all(bytes);
        }
        let folder = target.parent().filter(|f| !f.as_os_str().is_empty());
        let mut aside = tempfile::Builder::new();
        aside.prefix(".complete-mesh-").suffix(".tmp");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // Less the user's umask, like any new file; `tempfile` alone would make it private.
            aside.permissions(std::fs::Permissions::from_mode(0o666));
        }
        let mut aside = aside.tempfile_in(folder.unwrap_or(Path::new(".")))?;
        aside.write_all(bytes)?;
        if let Some(old) = old {
            aside.as_file().set_permissions(old.permissions())?;
        }
        aside.as_file().sync_all()?;
        aside.persist(&target).map(|_| ()).map_err(|e| e.error)
    };
    save().map_err(|source| IoError::Write { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_are_made_in_place() {
        let mut bytes = b"count 9; rows abc; more def.".to_vec();
        let edit = |at: Range<usize>, with: &str| Edit { at, with: with.into() };
        let edits =
            vec![edit(17..17, "XY"), edit(6..7, "10"), edit(27..27, "Z"), edit(17..17, "W")];
        splice(&mut bytes, edits);
        assert_eq!(String::from_utf8_lossy(&bytes), "count 10; rows abcXYW; more defZ.");
    }

    #[test]
    fn a_failed_save_leaves_no_trace() {
        let folder = tempfile::tempdir().unwrap();
        // A folder cannot be replaced by a file, so the last step fails.
        let target = folder.path().join("taken.ply");
        std::fs::create_dir(&target).unwrap();
        let error = save(&target, b"x").unwrap_err().to_string();
        assert!(error.contains("taken.ply") && error.contains("as it was"), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        let inside = folder.path().join("missing/x.ply");
        assert!(matches!(save(&inside, b"x"), Err(IoError::Write { .. })));
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_stay() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let [file, link] = ["a.ply", "b.ply"].map(|n| folder.path().join(n));
        std::fs::write(&file, b"old").unwrap();
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        save(&link, b"new").unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(std::fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
    }
}
