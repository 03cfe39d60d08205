//! What can go wrong with a mesh file, each case naming the place and what to do.

use super::Format;
use std::fmt;
use std::path::PathBuf;

/// Why a file was not read, changed or written. A document is unchanged after an error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// The system could not read the file.
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The system could not write the file; what was there before is still there.
    #[error("cannot write {}: {source}; the file is as it was before", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Neither the name nor the content tells the format.
    #[error("{}: not a known file; use .ply, .obj, .stl or .off, or for points .ply, .xyz or .pcd", .path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The content is broken: cut off, contradicting itself, or not of this format.
    #[error("{}: {place}: {reason}", .file.as_ref().map_or(format!("{format} data"), |f| f.display().to_string()))]
    Malformed {
        /// The file, when the data came from one.
        file: Option<PathBuf>,
        /// The format it was read as.
        format: Format,
        /// Where.
        place: Place,
        /// What is wrong, with the element, and what to do.
        reason: String,
    },
    /// The format, or this file's own layout, cannot hold what was asked for.
    #[error("{format}: {what}")]
    Unsupported {
        /// The format of the document.
        format: Format,
        /// What cannot be done, why, and what to do instead.
        what: String,
    },
    /// The completion was not made from this document's vertices and faces.
    #[error("the completion does not belong to this document: {reason}")]
    Mismatch {
        /// What does not fit.
        reason: String,
    },
}

/// Where in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A line of a text format, the first is 1.
    Line(usize),
    /// A byte of a binary format, the first is 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(n) => write!(f, "line {n}"),
            Place::Byte(n) => write!(f, "byte {n}"),
        }
    }
}

/// What the parsers return: the caller adds the format and the file's name.
#[derive(Debug)]
pub(super) struct Fault {
    pub place: Place,
    pub reason: String,
}

pub(super) type Parsed<T> = Result<T, Fault>;

impl Fault {
    pub fn line<T>(line: usize, reason: impl Into<String>) -> Parsed<T> {
        Err(Fault { place: Place::Line(line), reason: reason.into() })
    }

    pub fn byte<T>(byte: usize, reason: impl Into<String>) -> Parsed<T> {
        Err(Fault { place: Place::Byte(byte), reason: reason.into() })
    }

    /// Says which element the fault is in.
    pub fn within(mut self, element: &str, index: usize, count: usize) -> Self {
        self.reason = format!("{element} {index} of {count} (counted from 0): {}", self.reason);
        self
    }

    pub fn into_error(self, format: Format) -> IoError {
        IoError::Malformed { file: None, format, place: self.place, reason: self.reason }
    }
}
