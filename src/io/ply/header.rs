//! The header: which elements there are and how their rows are laid out.

use crate::io::error::{Fault, Parsed};
use crate::io::text::{line_end, parse, show, words, Line};
use std::ops::Range;

/// How the rows are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Little,
    Big,
}

/// The number types of the format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Element {
    pub name: String,
    /// How many rows the header promises.
    pub count: usize,
    /// Where the count's digits stand in the file.
    pub count_at: Range<usize>,
    pub properties: Vec<Property>,
    /// The byte after its last line in the header: where a further property goes.
    pub header_end: usize,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub line_end: &'static [u8],
    pub elements: Vec<Element>,
    /// The first byte and the first line of the rows.
    pub data_start: usize,
    pub data_line: usize,
}

impl Scalar {
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Scalar::I8,
            b"uchar" | b"uint8" => Scalar::U8,
            b"short" | b"int16" => Scalar::I16,
            b"ushort" | b"uint16" => Scalar::U16,
            b"int" | b"int32" => Scalar::I32,
            b"uint" | b"uint32" => Scalar::U32,
            b"float" | b"float32" => Scalar::F32,
            b"double" | b"float64" => Scalar::F64,
            _ => return None,
        })
    }

    /// Bytes it takes in the binary encodings.
    pub fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }

    pub fn is_integer(self) -> bool {
        !matches!(self, Scalar::F32 | Scalar::F64)
    }

    /// The least and the greatest value of an integer type.
    pub fn range(self) -> (f64, f64) {
        match self {
            Scalar::I8 => (i8::MIN.into(), i8::MAX.into()),
            Scalar::U8 => (0.0, u8::MAX.into()),
            Scalar::I16 => (i16::MIN.into(), i16::MAX.into()),
            Scalar::U16 => (0.0, u16::MAX.into()),
            Scalar::I32 => (i32::MIN.into(), i32::MAX.into()),
            Scalar::U32 => (0.0, u32::MAX.into()),
            Scalar::F32 => (f32::MIN.into(), f32::MAX.into()),
            Scalar::F64 => (f64::MIN, f64::MAX),
        }
    }
}

impl Element {
    /// Which property has this name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name)
    }

    /// Bytes of one binary row, if all rows are equally long.
    pub fn row_size(&self) -> Option<usize> {
        self.properties.iter().try_fold(0, |sum, p| match p.kind {
            Kind::Scalar(s) => Some(sum + s.size()),
            Kind::List { .. } => None,
        })
    }

    /// The fewest bytes that one row can take.
    pub fn min_row_size(&self, encoding: Encoding) -> usize {
        let size = |p: &Property| match (encoding, p.kind) {
            // A digit and a space.
            (Encoding::Ascii, _) => 2,
            (_, Kind::Scalar(s) | Kind::List { count: s, .. }) => s.size(),
        };
        self.properties.iter().map(size).sum()
    }
}

impl Header {
    pub fn find(&self, name: &str) -> Option<usize> {
        self.elements.iter().position(|e| e.name == name)
    }

    pub fn parse(bytes: &[u8]) -> Parsed<Header> {
        // The first line settles the line end: with a lone CR, a row may begin with an LF byte.
        let ending = line_end(bytes);
        let separator = ending[ending.len() - 1];
        let (mut at, mut number) = (0, 0);
        let mut next = || {
            let (start, rest) = (at, bytes.get(at..).filter(|rest| !rest.is_empty())?);
            let length = memchr::memchr(separator, rest).unwrap_or(rest.len());
            (at, number) = ((start + length + 1).min(bytes.len()), number + 1);
            Some(Line { text: rest[..length].trim_ascii_end(), number, start, end: at })
        };
        if next().is_none_or(|l| l.text != b"ply") {
            return Fault::line(1, "the file does not begin with the line \"ply\"");
        }
        let (mut encoding, mut elements) = (None, Vec::<Element>::new());
        while let Some(line) = next() {
            let mut rest = words(line.text);
            match rest.next().unwrap_or_default() {
                b"end_header" => {
                    let Some(encoding) = encoding else {
                        return Fault::line(
                            line.number,
                            "there is no \"format\" line before the end of the header",
                        );
                    };
                    let (data_start, data_line) = (line.end, line.number + 1);
                    return Ok(Header {
                        encoding,
                        line_end: ending,
                        elements,
                        data_start,
                        data_line,
                    });
                }
                b"comment" | b"obj_info" | b"" => {}
                b"format" => encoding = Some(parse_encoding(rest, line.number)?),
                b"element" => elements.push(parse_element(rest, bytes, &line, &elements)?),
                b"property" => {
                    let Some(element) = elements.last_mut() else {
                        return Fault::line(
                            line.number,
                            "a property comes before the first element",
                        );
                    };
                    element.properties.push(parse_property(rest, line.number)?);
                    element.header_end = line.end;
                }
                word => {
                    return Fault::line(
                        line.number,
                        format!("{} is not a header keyword", show(word)),
                    )
                }
            }
        }
        Fault::line(number + 1, "the header has no line \"end_header\"; the file is cut off")
    }
}

fn parse_encoding<'a>(mut rest: impl Iterator<Item = &'a [u8]>, line: usize) -> Parsed<Encoding> {
    let name = rest.next().unwrap_or_default();
    let encoding = match name {
        b"ascii" => Encoding::Ascii,
        b"binary_little_endian" => Encoding::Little,
        b"binary_big_endian" => Encoding::Big,
        _ => return Fault::line(line, format!("the format {} is unknown", show(name))),
    };
    match rest.next().unwrap_or_default() {
        b"1.0" => Ok(encoding),
        other => Fault::line(line, format!("the version {} is not 1.0", show(other))),
    }
}

fn parse_element<'a>(
    mut rest: impl Iterator<Item = &'a [u8]>,
    bytes: &[u8],
    line: &Line<'_>,
    before: &[Element],
) -> Parsed<Element> {
    let (Some(name), Some(count_word)) = (rest.next(), rest.next()) else {
        return Fault::line(line.number, "an element line needs a name and a count");
    };
    let Some(count) = parse::<usize>(count_word) else {
        let reason = format!("the count {} is not a whole number from 0", show(count_word));
        return Fault::line(line.number, reason);
    };
    let name = String::from_utf8_lossy(name).into_owned();
    if ["vertex", "face", "tristrips"].contains(&&*name) && before.iter().any(|e| e.name == name) {
        return Fault::line(line.number, format!("the element \"{name}\" comes twice"));
    }
    let start = count_word.as_ptr() as usize - bytes.as_ptr() as usize;
    let count_at = start..start + count_word.len();
    Ok(Element { name, count, count_at, properties: Vec::new(), header_end: line.end })
}

fn parse_property<'a>(mut rest: impl Iterator<Item = &'a [u8]>, line: usize) -> Parsed<Property> {
    let mut scalar = || {
        let word = rest.next().unwrap_or_default();
        match (word, Scalar::from_name(word)) {
            (b"list", _) => Ok(None),
            (_, Some(s)) => Ok(Some(s)),
            _ => Fault::line(line, format!("the type {} is unknown", show(word))),
        }
    };
    let kind = match scalar()? {
        Some(s) => Kind::Scalar(s),
        None => match (scalar()?, scalar()?) {
            (Some(count), Some(item)) if count.is_integer() => Kind::List { count, item },
            (Some(_), Some(_)) => {
                return Fault::line(line, "the count of a list is of a float type")
            }
            _ => return Fault::line(line, "a list of lists is not possible"),
        },
    };
    match rest.next() {
        Some(name) => Ok(Property { name: String::from_utf8_lossy(name).into_owned(), kind }),
        None => Fault::line(line, "the property has no name"),
    }
}
