//! Splits three-byte pixels into planes and merges them again, piece by piece, because loops over one colour
//! at a time vectorise well.

/// Number of pixels split at a time.
pub(super) const PIECE: usize = 512;

/// One colour of a piece.
pub(super) type Plane = [u8; PIECE];

/// Splits up to [`PIECE`] pixels.
#[inline(always)]
pub(super) fn split(pixels: &[[u8; 3]], red: &mut Plane, green: &mut Plane, blue: &mut Plane) {
    let colours = red.iter_mut().zip(green).zip(blue);
    for (((red, green), blue), pixel) in colours.zip(pixels) {
        (*red, *green, *blue) = (pixel[0], pixel[1], pixel[2]);
    }
}

/// Merges up to [`PIECE`] pixels.
#[inline(always)]
pub(super) fn merge(pixels: &mut [[u8; 3]], red: &[u8], green: &[u8], blue: &[u8]) {
    for (((pixel, &red), &green), &blue) in pixels.iter_mut().zip(red).zip(green).zip(blue) {
        *pixel = [red, green, blue];
    }
}

/// Applies a function to each pixel of a row.
#[inline(always)]
pub(super) fn map(row: &[u8], out: &mut [u8], point: impl Fn(u8, u8, u8) -> u8) {
    let (mut red, mut green, mut blue) = ([0; PIECE], [0; PIECE], [0; PIECE]);
    for (pixels, out) in row.as_chunks::<3>().0.chunks(PIECE).zip(out.chunks_mut(PIECE)) {
        split(pixels, &mut red, &mut green, &mut blue);
        for (((out, &red), &green), &blue) in out.iter_mut().zip(&red).zip(&green).zip(&blue) {
            *out = point(red, green, blue);
        }
    }
}
