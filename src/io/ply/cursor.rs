//! Reading the rows of an element, one encoding a type behind one trait.

use super::header::{Element, Encoding, Kind, Scalar};
use crate::io::error::{Fault, Parsed, Place};
use crate::io::text::{is_blank, parse, show, words, Lines};

/// Goes through the rows of the file. Every step checks what is left.
pub(super) trait Cursor {
    const ENCODING: Encoding;
    /// The byte the next row, or what follows the rows, begins at.
    fn at(&self) -> usize;
    fn place(&self) -> Place;
    /// Bytes left in the file.
    fn left(&self) -> usize;
    /// The byte the next value begins at, and the byte after the last one.
    fn value_start(&self) -> usize;
    fn value_end(&self) -> usize;
    fn begin_row(&mut self) -> Parsed<()>;
    /// Ends a row and returns the byte after its last value.
    fn end_row(&mut self) -> Parsed<usize>;
    fn integer(&mut self, s: Scalar) -> Parsed<i64>;
    fn real(&mut self, s: Scalar) -> Parsed<f64>;
    fn skip(&mut self, s: Scalar, n: usize) -> Parsed<()>;
    /// Steps over `rows` rows of `size` bytes at once, if the encoding allows it.
    fn jump(&mut self, rows: usize, size: usize) -> bool;
    /// Reads rows of a one-byte count of 3 and three 32-bit indices below `limit`, up to the first
    /// that is not so, and returns how many: nearly all rows of nearly all files. A file of 132,999
    /// vertices and 265,859 faces is read in 4 ms with it, in 10 ms without.
    fn plain_triangles(&mut self, _rows: usize, _limit: u32, _push: impl FnMut([u32; 3])) -> usize {
        0
    }
}

pub(super) struct Binary<'a, const BIG: bool> {
    pub bytes: &'a [u8],
    pub at: usize,
}

pub(super) struct Ascii<'a> {
    pub lines: Lines<'a>,
    row: &'a [u8],
}

impl<const BIG: bool> Binary<'_, BIG> {
    #[inline]
    fn take<const N: usize>(&mut self) -> Parsed<[u8; N]> {
        match self.bytes[self.at..].first_chunk::<N>() {
            Some(raw) => {
                let mut raw = *raw;
                self.at += N;
                if BIG {
                    raw.reverse();
                }
                Ok(raw)
            }
            None => self.cut_off(),
        }
    }

    #[cold]
    fn cut_off<T>(&self) -> Parsed<T> {
        Fault::byte(self.bytes.len(), "the file ends here; it is cut off, or a count is wrong")
    }
}

impl<const BIG: bool> Cursor for Binary<'_, BIG> {
    const ENCODING: Encoding = if BIG { Encoding::Big } else { Encoding::Little };

    fn at(&self) -> usize {
        self.at
    }

    fn place(&self) -> Place {
        Place::Byte(self.at)
    }

    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn value_start(&self) -> usize {
        self.at
    }

    fn value_end(&self) -> usize {
        self.at
    }

    fn begin_row(&mut self) -> Parsed<()> {
        Ok(())
    }

    fn end_row(&mut self) -> Parsed<usize> {
        Ok(self.at)
    }

    #[inline]
    fn integer(&mut self, s: Scalar) -> Parsed<i64> {
        Ok(match s {
            Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
            Scalar::F32 => f32::from_le_bytes(self.take()?) as i64,
            Scalar::F64 => f64::from_le_bytes(self.take()?) as i64,
        })
    }

    #[inline]
    fn real(&mut self, s: Scalar) -> Parsed<f64> {
        Ok(match s {
            Scalar::F32 => f32::from_le_bytes(self.take()?).into(),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
            // At most 32 bits: exact in f64.
            _ => self.integer(s)? as f64,
        })
    }

    #[inline]
    fn skip(&mut self, s: Scalar, n: usize) -> Parsed<()> {
        match n.checked_mul(s.size()).filter(|&size| size <= self.left()) {
            Some(size) => self.at += size,
            None => return self.cut_off(),
        }
        Ok(())
    }

    fn plain_triangles(
        &mut self,
        rows: usize,
        limit: u32,
        mut push: impl FnMut([u32; 3]),
    ) -> usize {
        let mut count = 0;
        for row in self.bytes[self.at..].chunks_exact(13).take(rows) {
            let face = [1, 5, 9].map(|k| {
                let raw = [row[k], row[k + 1], row[k + 2], row[k + 3]];
                if BIG {
                    u32::from_be_bytes(raw)
                } else {
                    u32::from_le_bytes(raw)
                }
            });
            if row[0] != 3 || face.iter().any(|&v| v >= limit) {
                break;
            }
            push(face);
            count += 1;
        }
        self.at += 13 * count;
        count
    }

    fn jump(&mut self, rows: usize, size: usize) -> bool {
        // `check_room` has seen that they are there.
        self.at += rows * size;
        true
    }
}

impl<'a> Ascii<'a> {
    pub fn new(lines: Lines<'a>) -> Self {
        Self { lines, row: &[] }
    }

    fn word(&mut self) -> Parsed<&'a [u8]> {
        let row = self.row.trim_ascii_start();
        let end = row.iter().position(u8::is_ascii_whitespace).unwrap_or(row.len());
        if end == 0 {
            return Fault::line(self.lines.number, "the line has too few numbers");
        }
        self.row = &row[end..];
        Ok(&row[..end])
    }
}

impl Cursor for Ascii<'_> {
    const ENCODING: Encoding = Encoding::Ascii;

    fn at(&self) -> usize {
        self.lines.at
    }

    fn place(&self) -> Place {
        Place::Line(self.lines.number)
    }

    fn left(&self) -> usize {
        self.lines.bytes.len() - self.lines.at
    }

    fn value_start(&self) -> usize {
        self.value_end() + self.row.len() - self.row.trim_ascii_start().len()
    }

    fn value_end(&self) -> usize {
        self.row.as_ptr() as usize - self.lines.bytes.as_ptr() as usize
    }

    fn begin_row(&mut self) -> Parsed<()> {
        match self.lines.by_ref().find(|l| !is_blank(l.text)) {
            Some(line) => self.row = line.text,
            None => {
                let reason = "the file ends here; it is cut off, or a count is wrong";
                return Fault::line(self.lines.number + 1, reason);
            }
        }
        Ok(())
    }

    fn end_row(&mut self) -> Parsed<usize> {
        match words(self.row).next() {
            None => Ok(self.value_end()),
            Some(word) => {
                let reason =
                    format!("the line has more numbers than the header says: {}", show(word));
                Fault::line(self.lines.number, reason)
            }
        }
    }

    fn integer(&mut self, _: Scalar) -> Parsed<i64> {
        let word = self.word()?;
        match parse(word) {
            Some(n) => Ok(n),
            None => Fault::line(self.lines.number, format!("{} is not a whole number", show(word))),
        }
    }

    fn real(&mut self, s: Scalar) -> Parsed<f64> {
        let word = self.word()?;
        // Through f32, not by rounding an f64 a second time.
        let value = if s == Scalar::F32 { parse::<f32>(word).map(f64::from) } else { parse(word) };
        match value {
            Some(x) => Ok(x),
            None => Fault::line(self.lines.number, format!("{} is not a number", show(word))),
        }
    }

    fn skip(&mut self, _: Scalar, n: usize) -> Parsed<()> {
        (0..n).try_for_each(|_| self.word().map(|_| ()))
    }

    fn jump(&mut self, _: usize, _: usize) -> bool {
        false
    }
}

/// Checks that `element`'s rows can be there at all, before anything is reserved for them.
pub(super) fn check_room<C: Cursor>(cursor: &C, element: &Element) -> Parsed<()> {
    let row = element.min_row_size(C::ENCODING);
    // The last line of a text may lack its line end.
    let left = cursor.left() + usize::from(C::ENCODING == Encoding::Ascii);
    if row > 0 && element.count > left / row {
        let (count, name) = (element.count, &element.name);
        let reason = format!(
            "{count} rows of element \"{name}\" cannot be in the {} bytes that are left; the file \
             is cut off, or the count is wrong",
            cursor.left()
        );
        return Err(Fault { place: cursor.place(), reason });
    }
    Ok(())
}

/// Reads a list's count.
#[inline]
pub(super) fn list_count<C: Cursor>(cursor: &mut C, count: Scalar) -> Parsed<usize> {
    let n = cursor.integer(count)?;
    let reason = || format!("a list has the count {n}");
    usize::try_from(n).map_err(|_| Fault { place: cursor.place(), reason: reason() })
}

/// Goes over the rows of `element`. `visit` gets the row's number, each property's index and kind,
/// and has to consume the property's value; `after` gets the byte after each row's last value.
pub(super) fn each_row<C: Cursor>(
    cursor: &mut C,
    element: &Element,
    visit: impl FnMut(&mut C, usize, usize, Kind) -> Parsed<()>,
    after: impl FnMut(usize),
) -> Parsed<()> {
    check_room(cursor, element)?;
    each_row_from(cursor, element, 0, visit, after)
}

/// The same from row `first` on, where the cursor is; the room has been checked.
pub(super) fn each_row_from<C: Cursor>(
    cursor: &mut C,
    element: &Element,
    first: usize,
    mut visit: impl FnMut(&mut C, usize, usize, Kind) -> Parsed<()>,
    mut after: impl FnMut(usize),
) -> Parsed<()> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for row in first..element.count {
        let mut read = || {
            cursor.begin_row()?;
            for (i, p) in element.properties.iter().enumerate() {
                visit(cursor, row, i, p.kind)?;
            }
            after(cursor.end_row()?);
            Ok(())
        };
        read().map_err(|f: Fault| f.within(&element.name, row, element.count))?;
    }
    Ok(())
}

/// Steps over one value.
#[inline]
pub(super) fn skip_value<C: Cursor>(cursor: &mut C, kind: Kind) -> Parsed<()> {
    match kind {
        Kind::Scalar(s) => cursor.skip(s, 1),
        Kind::List { count, item } => {
            let n = list_count(cursor, count)?;
            cursor.skip(item, n)
        }
    }
}

/// Steps over all rows of `element`.
pub(super) fn skip_rows<C: Cursor>(cursor: &mut C, element: &Element) -> Parsed<()> {
    check_room(cursor, element)?;
    match element.row_size() {
        Some(size) if cursor.jump(element.count, size) => Ok(()),
        _ => each_row(cursor, element, |c, _, _, kind| skip_value(c, kind), |_| ()),
    }
}
