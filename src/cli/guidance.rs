//! Guidance by hand, as said on the command line.

use super::failure::Failure;
use crate::guidance::{Guidance, Placement};
use crate::io::Document;
use crate::matching::rigid::Rigid;
use clap::Args;
use std::path::PathBuf;
use std::sync::Arc;

/// Where to copy from, given by hand.
#[derive(Debug, Default, Args)]
pub(super) struct GuidanceArgs {
    /// The one place to copy from: source to hole, 12 or 16 numbers row by row, or a file with them
    #[arg(long, value_name = "NUMBERS|FILE", allow_hyphen_values = true)]
    pub transform: Option<String>,
    /// Improve --transform by what is known around the hole
    #[arg(long, requires = "transform")]
    pub refine_transform: bool,
    /// Make a fill of each of the N best places, and write them as OUT-1, OUT-2, ...
    #[arg(long, value_name = "N", conflicts_with_all = ["transform", "candidate"], value_parser = at_least_one)]
    pub candidates: Option<usize>,
    /// Make the fill from the I-th best place alone, counted from 1
    #[arg(long, value_name = "I", conflicts_with = "transform", value_parser = at_least_one)]
    pub candidate: Option<usize>,
    /// Sources may be scaled by a factor in this range
    #[arg(long, value_name = "MIN,MAX", conflicts_with = "transform", value_parser = parse_scale)]
    pub scale: Option<Scales>,
    /// Take a missing part whole, with the source's own triangles: a hand, a foot, a spout
    #[arg(long)]
    pub part: bool,
    /// Rim vertices where the fill need only be joined, not go on from what lies beyond
    #[arg(long, value_name = "I,..", value_delimiter = ',')]
    pub loose: Vec<u32>,
    /// Points that the fills pass through: the vertices of a mesh or cloud
    #[arg(long, value_name = "FILE")]
    pub points: Option<PathBuf>,
    /// How far fills may stay off the points, 0 (not at all) to 1
    #[arg(long, value_name = "S", requires = "points", default_value_t = 0.0)]
    pub softness: f64,
}

/// A type of its own, or clap takes it for a repeated argument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scales([f64; 2]);

fn at_least_one(text: &str) -> Result<usize, String> {
    let number = text.parse().map_err(|_| "expected a number from 1".to_owned())?;
    match number {
        0 => Err("candidates are counted from 1".into()),
        number => Ok(number),
    }
}

fn parse_scale(text: &str) -> Result<Scales, String> {
    match numbers(text).as_deref() {
        Some(&[least, most]) => Ok(Scales([least, most])),
        _ => Err("expected two numbers, MIN,MAX".into()),
    }
}

/// Numbers with commas or space between them.
fn numbers(text: &str) -> Option<Vec<f64>> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|w| !w.is_empty());
    words.map(|w| w.parse().ok()).collect()
}

impl GuidanceArgs {
    /// The library's guidance. A file of `--transform` is read here.
    pub fn guidance(&self) -> Result<Guidance, Failure> {
        let refined = self.refine_transform;
        let placement =
            |text: &String| Ok::<_, Failure>(Placement { transform: transform(text)?, refined });
        Ok(Guidance {
            placement: self.transform.as_ref().map(placement).transpose()?,
            candidate: self.candidate.unwrap_or_default(),
            scales: self.scale.map(|s| s.0),
            points: self.points()?,
            part: self.part,
            loose: self.loose.clone().into(),
            softness: self.softness,
        })
    }

    fn points(&self) -> Result<Arc<[[f64; 3]]>, Failure> {
        let Some(path) = &self.points else { return Ok(Arc::default()) };
        let file = Document::read(path)?;
        Ok((0..file.vertices().len()).map(|v| file.vertices().get(v)).collect())
    }
}

/// A transform from numbers, or from the file that the text names.
fn transform(text: &str) -> Result<Rigid, Failure> {
    if let Some(given) = numbers(text) {
        return of_rows(&given).map_err(|why| Failure::Usage(format!("--transform: {why}")));
    }
    let content = std::fs::read_to_string(text).map_err(|e| {
        Failure::Usage(format!("--transform: {text:?} is neither numbers nor a file to read: {e}"))
    })?;
    let given = numbers(&content).ok_or_else(|| {
        Failure::Usage(format!("--transform: {text} has something that is no number"))
    })?;
    of_rows(&given).map_err(|why| Failure::Usage(format!("--transform: {text}: {why}")))
}

fn of_rows(rows: &[f64]) -> Result<Rigid, String> {
    if rows.len() == 16 && rows[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err("the fourth row is not 0 0 0 1".into());
    }
    if rows.len() != 12 && rows.len() != 16 {
        return Err(format!("{} numbers instead of 12 or 16", rows.len()));
    }
    Ok(Rigid::from_rows([0, 1, 2].map(|i| [0, 1, 2, 3].map(|j| rows[4 * i + j]))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DVec3};

    #[test]
    fn transforms_are_rows() {
        let wanted = Rigid {
            linear: DMat3::from_cols_array_2d(&[
                [0.0, 1.0, 0.0],
                [-1.0, 0.0, 0.0],
                [0.0, 0.0, 1.0],
            ]),
            translation: DVec3::new(5.0, 6.0, -7.5),
        };
        let same = |text: &str| assert_eq!(transform(text).unwrap(), wanted, "{text}");
        same("0,-1,0,5, 1,0,0,6, 0,0,1,-7.5");
        same("0 -1 0 5\n1 0 0 6\n0 0 1 -7.5\n0 0 0 1\n");
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "0 -1 0 5\n1 0 0 6\n0 0 1 -7.5\n").unwrap();
        same(file.path().to_str().unwrap());
        for (bad, word) in [
            ("1,2,3", "3 numbers"),
            ("", "0 numbers"),
            ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2", "fourth row"),
            ("no-such-file", "neither"),
        ] {
            let failure = transform(bad).unwrap_err();
            assert!(failure.code() == 2 && failure.to_string().contains(word), "{failure}");
        }
        std::fs::write(file.path(), "0 -1 zero 5").unwrap();
        let said = transform(file.path().to_str().unwrap()).unwrap_err().to_string();
        assert!(said.contains("no number"), "{said}");
    }

    #[test]
    fn scales_and_counts_are_numbers() {
        assert_eq!(parse_scale("0.5, 2"), Ok(Scales([0.5, 2.0])));
        assert!(["", "1", "1,2,3", "a,b"].iter().all(|bad| parse_scale(bad).is_err()));
        assert!(
            at_least_one("3") == Ok(3) && at_least_one("0").is_err() && at_least_one("-1").is_err()
        );
    }
}
