//! RoBIOS's image processing, based on [`roverlab::vision`].

use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Read, Write};
use std::path::Path;

use roverlab::io::{Error, ErrorKind, Resolution, Result};
use roverlab::vision::{
    Border, GrayView, GrayViewMut, GrayWeights, HueLimits, HueScale, NO_HUE, RgbView, RgbViewMut, SobelScale,
    gray_into, gray_to_rgb_into, hue, laplace_into, overlay_gray_into, overlay_into, sobel_l1_into,
};
use roverlab::world::Colour;

/// Columns and rows.
pub(crate) type Size = (usize, usize);

/// Number of columns and rows of a resolution.
pub(crate) fn size(resolution: Resolution) -> Size {
    let (width, height) = resolution.dimensions();
    (width as usize, height as usize)
}

/// Number of columns and rows of a resolution by RoBIOS's number.
pub(crate) fn named_size(number: i32) -> Result<Size> {
    let found = usize::try_from(number).ok().and_then(|n| Resolution::ALL.get(n).copied());
    found.map(size).ok_or_else(|| Error::invalid_input("image resolution", number, "0 to 5"))
}

/// The kernels reject images of the wrong size; the callers here guarantee the size.
macro_rules! fitting {
    ($call:expr) => {
        let _ = (|| $call)();
    };
}

/// `IPCol2Gray`.
pub(crate) fn gray(input: &[u8], output: &mut [u8], (w, h): Size) {
    fitting!(gray_into(RgbView::new(input, w, h)?, GrayViewMut::new(output, w, h)?, GrayWeights::Robios));
}

/// `IPGray2Col`.
pub(crate) fn colour(input: &[u8], output: &mut [u8], (w, h): Size) {
    fitting!(gray_to_rgb_into(GrayView::new(input, w, h)?, RgbViewMut::new(output, w, h)?));
}

/// `IPLaplace`.
pub(crate) fn laplace(input: &[u8], output: &mut [u8], (w, h): Size) {
    fitting!(laplace_into(GrayView::new(input, w, h)?, GrayViewMut::new(output, w, h)?, Border::Zero));
}

/// `IPSobel`.
pub(crate) fn sobel(input: &[u8], output: &mut [u8], (w, h): Size) {
    let third = SobelScale::Third;
    fitting!(sobel_l1_into(
        GrayView::new(input, w, h)?,
        GrayViewMut::new(output, w, h)?,
        third,
        Border::Zero
    ));
}

/// `IPOverlay`.
pub(crate) fn overlay(base: &[u8], top: &[u8], output: &mut [u8], (w, h): Size) {
    fitting!(overlay_into(
        RgbView::new(base, w, h)?,
        RgbView::new(top, w, h)?,
        RgbViewMut::new(output, w, h)?
    ));
}

/// `IPOverlayGray`.
pub(crate) fn overlay_gray(base: &[u8], marks: &[u8], colour: Colour, output: &mut [u8], (w, h): Size) {
    fitting!(overlay_gray_into(
        GrayView::new(base, w, h)?,
        GrayView::new(marks, w, h)?,
        colour,
        RgbViewMut::new(output, w, h)?
    ));
}

/// `IPRGB2Col`.
pub(crate) fn merge(planes: [&[u8]; 3], output: &mut [u8]) {
    let [red, green, blue] = planes;
    let pixels = output.as_chunks_mut::<3>().0.iter_mut();
    for (((pixel, &red), &green), &blue) in pixels.zip(red).zip(green).zip(blue) {
        *pixel = [red, green, blue];
    }
}

/// `IPCol2HSI`.
pub(crate) fn split_hsi(input: &[u8], [hues, saturations, intensities]: [&mut [u8]; 3]) {
    let pixels = input.as_chunks::<3>().0.iter();
    for (((&pixel, h), s), i) in pixels.zip(hues).zip(saturations).zip(intensities) {
        [*h, *s, *i] = hsi(pixel);
    }
}

/// `IPPRGB2Hue`: 0 for pixels without a hue.
pub(crate) fn hue_of(pixel: [u8; 3]) -> u8 {
    match hue(pixel, HueScale::Robios, HueLimits::default()) {
        NO_HUE => 0,
        hue => hue,
    }
}

/// `IPPRGB2HSI`.
pub(crate) fn hsi(pixel: [u8; 3]) -> [u8; 3] {
    let [red, green, blue] = pixel.map(i32::from);
    let intensity = (red + blue) / 4 + green / 2;
    let least = red.min(green).min(blue);
    let saturation = if intensity == 0 { 0 } else { 255 - 255 * least / intensity };
    [hue_of(pixel), saturation.clamp(0, 255) as u8, intensity as u8]
}

/// Content of a PNM file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Pnm {
    /// 1 is black.
    Binary(Vec<u8>),
    Gray(Vec<u8>),
    Colour(Vec<u8>),
}

/// Maximum size of an image (pixels).
const LARGEST: usize = 100_000_000;

/// `IPReadFile`: a PNM file, cropped or padded with black to a size, from its upper left corner.
pub(crate) fn read_file(path: &Path, size: Size) -> Result<Pnm> {
    let file = File::open(path).map_err(|error| unreadable(path, &error))?;
    parse(&mut BufReader::new(file), size).map_err(|error| unreadable(path, &error))
}

fn unreadable(path: &Path, error: &std::io::Error) -> Error {
    Error::new(ErrorKind::InvalidInput, format!("{}: {error}; expected a PNM image", path.display()))
}

fn parse(file: &mut impl BufRead, (columns, rows): Size) -> std::io::Result<Pnm> {
    let mut magic = [0; 2];
    file.read_exact(&mut magic)?;
    let kind = magic[1].wrapping_sub(b'0');
    if magic[0] != b'P' || !(1..=6).contains(&kind) {
        return Err(broken("no image of type P1 to P6"));
    }
    let (plain, channels, binary) = (kind < 4, if kind % 3 == 0 { 3 } else { 1 }, kind % 3 == 1);
    let (width, height) = (next_number(file)?, next_number(file)?);
    let largest = if binary { 1 } else { next_number(file)? };
    if width == 0 || height == 0 || width.saturating_mul(height) > LARGEST || !(1..=65_535).contains(&largest)
    {
        return Err(broken("an image of an impossible size"));
    }
    let mut output = vec![0; columns * rows * channels];
    for y in 0..height {
        let row = match (plain, binary) {
            (true, true) => (0..width).map(|_| next_digit(file)).collect::<std::io::Result<Vec<u8>>>()?,
            (true, false) => {
                let values = (0..width * channels).map(|_| next_number(file));
                values
                    .map(|value| Ok((value?.min(largest) * 255 / largest) as u8))
                    .collect::<std::io::Result<_>>()?
            }
            (false, true) => {
                let mut packed = vec![0; width.div_ceil(8)];
                file.read_exact(&mut packed)?;
                (0..width).map(|x| packed[x / 8] >> (7 - x % 8) & 1).collect()
            }
            (false, false) => raw_row(file, width * channels, largest)?,
        };
        if y < rows {
            let length = columns.min(width) * channels;
            output[y * columns * channels..][..length].copy_from_slice(&row[..length]);
        }
    }
    Ok(match kind % 3 {
        1 => Pnm::Binary(output),
        2 => Pnm::Gray(output),
        _ => Pnm::Colour(output),
    })
}

fn raw_row(file: &mut impl BufRead, length: usize, largest: usize) -> std::io::Result<Vec<u8>> {
    let wide = largest > 255;
    let mut row = vec![0; length * if wide { 2 } else { 1 }];
    file.read_exact(&mut row)?;
    let scale = |value: usize| (value.min(largest) * 255 / largest) as u8;
    Ok(if wide {
        row.as_chunks::<2>().0.iter().map(|&pair| scale(u16::from_be_bytes(pair).into())).collect()
    } else {
        row.into_iter().map(|byte| scale(byte.into())).collect()
    })
}

fn broken(what: &str) -> std::io::Error {
    std::io::Error::new(std::io::ErrorKind::InvalidData, what.to_owned())
}

fn next_byte(file: &mut impl BufRead) -> std::io::Result<u8> {
    let mut byte = [0];
    file.read_exact(&mut byte)?;
    Ok(byte[0])
}

/// The next character outside blanks and comments.
fn next_letter(file: &mut impl BufRead) -> std::io::Result<u8> {
    loop {
        match next_byte(file)? {
            b'#' => {
                let mut comment = Vec::new();
                file.take(65_536).read_until(b'\n', &mut comment)?;
            }
            byte if byte.is_ascii_whitespace() => {}
            byte => return Ok(byte),
        }
    }
}

fn next_digit(file: &mut impl BufRead) -> std::io::Result<u8> {
    match next_letter(file)? {
        byte @ (b'0' | b'1') => Ok(byte - b'0'),
        _ => Err(broken("a letter among the pixels")),
    }
}

/// The next number, including the blank after it.
fn next_number(file: &mut impl BufRead) -> std::io::Result<usize> {
    let mut value = usize::from(digit(next_letter(file)?)?);
    loop {
        let byte = match next_byte(file) {
            // The last number of a file needs no blank after it.
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => return Ok(value),
            byte => byte?,
        };
        if byte.is_ascii_whitespace() {
            return Ok(value);
        }
        value = value.saturating_mul(10).saturating_add(digit(byte)?.into());
    }
}

fn digit(byte: u8) -> std::io::Result<u8> {
    if byte.is_ascii_digit() { Ok(byte - b'0') } else { Err(broken("a letter in place of a number")) }
}

/// `IPWriteFile` and `IPWriteFileGray`: three bytes per pixel, or one.
pub(crate) fn write_file(path: &Path, data: &[u8], (width, height): Size) -> Result<()> {
    let kind = if data.len() == width * height { 5 } else { 6 };
    let write = || {
        let mut file = BufWriter::new(File::create(path)?);
        write!(file, "P{kind}\n{width} {height}\n255\n")?;
        file.write_all(data)?;
        file.flush()
    };
    write().map_err(|error| Error::new(ErrorKind::Other, format!("{}: {error}", path.display())))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8], size: Size) -> std::io::Result<Pnm> {
        parse(&mut BufReader::new(text), size)
    }

    #[test]
    fn all_six_kinds_are_read() {
        assert_eq!(read(b"P1 # a comment\n3 1\n1 0 1\n", (3, 1)).unwrap(), Pnm::Binary(vec![1, 0, 1]));
        assert_eq!(read(b"P1 3 1 101", (2, 1)).unwrap(), Pnm::Binary(vec![1, 0]));
        assert_eq!(read(b"P2\n2 1 100\n0 100", (3, 1)).unwrap(), Pnm::Gray(vec![0, 255, 0]));
        assert_eq!(read(b"P3 1 1 255 1 2 3", (1, 1)).unwrap(), Pnm::Colour(vec![1, 2, 3]));
        assert_eq!(read(b"P4 3 1\n\xa0", (3, 1)).unwrap(), Pnm::Binary(vec![1, 0, 1]));
        assert_eq!(read(b"P5 2 2 255\nabcd", (1, 2)).unwrap(), Pnm::Gray(b"ac".to_vec()));
        assert_eq!(read(b"P6 1 1 255\nabc", (1, 1)).unwrap(), Pnm::Colour(b"abc".to_vec()));
    }

    #[test]
    fn broken_files_are_refused() {
        for text in [
            "",
            "P7 1 1",
            "P5 0 1 255\n",
            "P5 2 2 255\nab",
            "P2 x 1",
            "P5 99999999 99999999 255\n",
            "P3 1 1 0 1",
        ] {
            assert!(read(text.as_bytes(), (2, 2)).is_err(), "{text}");
        }
    }

    #[test]
    fn a_pixel_has_robios_hue_saturation_and_intensity() {
        assert_eq!(hsi([255, 0, 0]), [42, 255, 63]);
        assert_eq!(hsi([0, 255, 0]), [126, 255, 127]);
        assert_eq!(hsi([100, 100, 100]), [0, 0, 100]);
        assert_eq!(hsi([0, 0, 0]), [0, 0, 0]);
        assert_eq!(hue_of([128, 128, 128]), 0);
    }
}
