//! What ends a command, and the exit code it stands for.

use crate::error::Error;
use crate::io::IoError;

/// Exit code of a wrong command line; clap's own.
pub(super) const USAGE: u8 = 2;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    /// The arguments contradict each other.
    #[error("{0}")]
    Usage(String),
    /// Nothing serves where only sources were asked for.
    #[error("no candidate: nothing that may be copied from looks like what is around the holes")]
    NoCandidate,
    /// A mesh file was not read or written.
    #[error(transparent)]
    File(#[from] IoError),
    /// The library refused.
    #[error(transparent)]
    Library(#[from] Error),
}

impl Failure {
    /// A file that could not be written.
    pub fn writing(path: &std::path::Path, source: std::io::Error) -> Self {
        Failure::File(IoError::Write { path: path.to_owned(), source })
    }

    /// The exit code.
    pub fn code(&self) -> u8 {
        match self {
            Failure::Usage(_) => USAGE,
            Failure::NoCandidate => 1,
            Failure::File(_) => 3,
            Failure::Library(error) => match error {
                Error::UnsafeHole { .. } | Error::HoleFailed { .. } => 1,
                Error::Cancelled => 130,
                Error::Empty
                | Error::NonFinite { .. }
                | Error::NonFinitePoint { .. }
                | Error::TooFewPoints { .. }
                | Error::PointsOnALine { .. }
                | Error::NoSurface { .. }
                | Error::IndexOutOfRange { .. }
                | Error::TooLarge { .. }
                | Error::NoSuchHole { .. }
                | Error::InvalidOption { .. }
                | Error::Unsupported { .. } => 4,
            },
        }
    }

    /// What to try next, in the words of the command line.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Failure::Library(Error::UnsafeHole { .. } | Error::HoleFailed { .. }) => {
                Some("--skip-unsafe fills the other holes; `complete-mesh holes` lists all")
            }
            Failure::Library(Error::NoSuchHole { .. }) => {
                Some("`complete-mesh holes FILE` lists the holes and their ids")
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_the_documented_ones() {
        let cases = [
            (Failure::Usage("x".into()), 2),
            (Failure::writing("x".as_ref(), std::io::Error::other("full")), 3),
            (Failure::from(Error::HoleFailed { hole: 1, reason: "x".into() }), 1),
            (Failure::from(Error::Empty), 4),
            (Failure::from(Error::Unsupported { what: "x".into() }), 4),
            (Failure::from(Error::Cancelled), 130),
        ];
        for (failure, code) in cases {
            assert_eq!(failure.code(), code, "{failure}");
        }
        let page = include_str!("../../docs/cli.md");
        for row in ["| 0 |", "| 1 |", "| 2 |", "| 3 |", "| 4 |", "| 130 |"] {
            assert!(page.contains(row), "docs/cli.md does not list {row}");
        }
    }
}
