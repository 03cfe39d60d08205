//! Lines, words and numbers of the text formats.

use super::error::{Fault, Parsed};
use std::io::Write;

/// One line: `text` without its line end, which may be LF, CR LF or a lone CR.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    pub text: &'a [u8],
    /// Counted from 1.
    pub number: usize,
    /// Byte of its first character.
    pub start: usize,
    /// Byte after its line end.
    pub end: usize,
}

/// The lines of `bytes` from byte `at` on.
#[derive(Clone)]
pub(super) struct Lines<'a> {
    pub bytes: &'a [u8],
    pub at: usize,
    /// Number of the last line given out.
    pub number: usize,
}

impl<'a> Lines<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, number: 0 }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let start = self.at;
        if start >= self.bytes.len() {
            return None;
        }
        let rest = &self.bytes[start..];
        let length = memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        let line_end = match (rest.get(length), rest.get(length + 1)) {
            (None, _) => 0,
            (Some(b'\r'), Some(b'\n')) => 2,
            _ => 1,
        };
        self.at = start + length + line_end;
        self.number += 1;
        Some(Line { text: &rest[..length], number: self.number, start, end: self.at })
    }
}

/// The words of a line.
pub(super) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> + Clone {
    text.split(|c| c.is_ascii_whitespace()).filter(|w| !w.is_empty())
}

pub(super) fn is_blank(text: &[u8]) -> bool {
    text.iter().all(u8::is_ascii_whitespace)
}

/// A number in a word; NaN and infinities count as numbers.
pub(super) fn parse<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A word as it is shown in an error: short, and harmless on a terminal.
pub(super) fn show(word: &[u8]) -> String {
    let word = &word[..word.len().min(24)];
    format!("\"{}\"", word.escape_ascii())
}

/// A coordinate: a finite number.
pub(super) fn coordinate(word: &[u8], line: usize) -> Parsed<f64> {
    match parse::<f64>(word) {
        Some(x) if x.is_finite() => Ok(x),
        Some(_) => Fault::line(line, format!("the coordinate {} is not finite", show(word))),
        None => Fault::line(line, format!("{} is not a number", show(word))),
    }
}

/// The line end that a text uses, from its first one; LF if it has none.
pub(super) fn line_end(bytes: &[u8]) -> &'static [u8] {
    match memchr::memchr2(b'\n', b'\r', bytes) {
        Some(at) if bytes[at] == b'\r' && bytes.get(at + 1) == Some(&b'\n') => b"\r\n",
        Some(at) if bytes[at] == b'\r' => b"\r",
        _ => b"\n",
    }
}

/// The shortest text that reads back as the same f32 (`single`) or f64.
pub(super) fn push_real(out: &mut Vec<u8>, x: f64, single: bool) {
    let size = x.abs();
    // Beyond these C's "%g" changes to an exponent, too; plain digits would be needlessly long.
    let plain = size == 0.0 || (1e-5..1e16).contains(&size) || !x.is_finite();
    // Writing to memory does not fail.
    let _ = match (single, plain) {
        (true, true) => write!(out, "{}", x as f32),
        (true, false) => write!(out, "{:e}", x as f32),
        (false, true) => write!(out, "{x}"),
        (false, false) => write!(out, "{x:e}"),
    };
}

/// Whether a coordinate's text says nothing that f32 would lose: the f32 next to its value lies
/// within half a unit of the last digit written.
pub(super) fn fits_single(word: &[u8], value: f64) -> bool {
    let rounded = value as f32;
    if f64::from(rounded) == value {
        return true;
    }
    let mantissa = word.split(|c| matches!(c, b'e' | b'E')).next().unwrap_or(word);
    let exponent = word.get(mantissa.len() + 1..).and_then(parse::<i32>).unwrap_or(0);
    let decimals = mantissa.iter().position(|&c| c == b'.').map_or(0, |p| mantissa.len() - p - 1);
    let last_digit =
        10f64.powi(exponent.saturating_sub(i32::try_from(decimals).unwrap_or(i32::MAX)));
    rounded.is_finite() && (f64::from(rounded) - value).abs() <= 0.5 * last_digit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_any_of_the_three_ways() {
        let text = b"a\nb\r\nc\rd";
        let lines: Vec<_> = Lines::new(text).map(|l| (l.text.to_vec(), l.start, l.end)).collect();
        assert_eq!(
            lines,
            [
                (b"a".to_vec(), 0, 2),
                (b"b".to_vec(), 2, 5),
                (b"c".to_vec(), 5, 7),
                (b"d".to_vec(), 7, 8)
            ]
        );
        assert_eq!(line_end(b"x\r\ny"), b"\r\n");
        assert_eq!(line_end(b"x\ry"), b"\r");
        assert_eq!(line_end(b"x"), b"\n");
    }

    #[test]
    fn numbers_read_back_as_the_same_bits() {
        for x in [0.1f32, -0.0, 1e-30, 3.4e38, 1.0, 123456.79, f32::MIN_POSITIVE, 16_777_216.0] {
            let mut out = Vec::new();
            push_real(&mut out, f64::from(x), true);
            assert_eq!(parse::<f32>(&out).unwrap().to_bits(), x.to_bits());
        }
        for x in [0.1f64, 1e-300, 1.0 / 3.0, 1e300, -1e16] {
            let mut out = Vec::new();
            push_real(&mut out, x, false);
            assert_eq!(parse::<f64>(&out).unwrap().to_bits(), x.to_bits());
        }
    }

    #[test]
    fn single_precision_is_chosen_by_the_digits_written() {
        let fits = |s: &str| fits_single(s.as_bytes(), s.parse().unwrap());
        // Six digits always fit, nine as printed from an f32 do.
        assert!(fits("0.123457") && fits("0.100000001") && fits("1e-7") && fits("-5"));
        // A survey coordinate to the millimetre and a full f64 do not.
        assert!(!fits("500123.123") && !fits("0.12345678901234") && !fits("16777217"));
        assert!(!fits("1e39"));
    }
}
