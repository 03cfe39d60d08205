//! Image files of textures: PNG and JPEG.

use super::Image;
use std::io::{Cursor, Error, Result};

/// Longest side that is read, in pixels: what graphics cards take. A header can claim more than memory has.
const LONGEST: usize = 16384;

impl Image {
    /// Reads a PNG or JPEG file's content; transparency is left away. An error says what is wrong.
    pub fn decode(bytes: &[u8]) -> Result<Self> {
        match bytes {
            [0x89, b'P', b'N', b'G', ..] => decode_png(bytes),
            [0xff, 0xd8, ..] => decode_jpeg(bytes),
            _ => Err(Error::other("it is neither PNG nor JPEG")),
        }
    }

    fn of_channels(width: usize, height: usize, channels: usize, bytes: &[u8]) -> Result<Self> {
        if channels == 0 || bytes.len() < width * height * channels {
            return Err(Error::other("it is cut off"));
        }
        // One and two channels are grey, the last of two and four is alpha.
        let pixel = |p: &[u8]| if channels < 3 { [p[0]; 3] } else { [p[0], p[1], p[2]] };
        let pixels = bytes.chunks_exact(channels).take(width * height).map(pixel).collect();
        Ok(Self { width, height, pixels })
    }
}

fn check_size(width: usize, height: usize) -> Result<()> {
    if width > LONGEST || height > LONGEST {
        return Err(Error::other(format!(
            "it has {width} x {height} pixels; at most {LONGEST} a side are read"
        )));
    }
    Ok(())
}

fn decode_png(bytes: &[u8]) -> Result<Image> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info()?;
    check_size(reader.info().width as usize, reader.info().height as usize)?;
    let size = reader.output_buffer_size().ok_or_else(|| Error::other("it is too large"))?;
    let mut data = vec![0; size];
    let info = reader.next_frame(&mut data)?;
    let (width, height) = (info.width as usize, info.height as usize);
    Image::of_channels(width, height, info.color_type.samples(), &data)
}

fn decode_jpeg(bytes: &[u8]) -> Result<Image> {
    use zune_jpeg::zune_core::bytestream::ZCursor;
    use zune_jpeg::zune_core::colorspace::ColorSpace;
    use zune_jpeg::zune_core::options::DecoderOptions;
    let options = DecoderOptions::default()
        .jpeg_set_out_colorspace(ColorSpace::RGB)
        .set_max_width(LONGEST)
        .set_max_height(LONGEST);
    let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    let data = decoder.decode().map_err(|e| Error::other(e.to_string()))?;
    let (width, height) = decoder.dimensions().ok_or_else(|| Error::other("it has no size"))?;
    Image::of_channels(width, height, 3, &data)
}
