/// A colour as a number, `0xRRGGBB`.
pub(super) type Packed = u32;

/// A picture being drawn: colours and a depth buffer.
#[derive(Debug, Default)]
pub(super) struct Canvas {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) colours: Vec<Packed>,
    /// Inverse depth along the line of sight; 0 at infinity.
    pub(super) nearness: Vec<f32>,
}

/// Columns of a shape in one row, as a half-open interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    pub(super) left: f64,
    pub(super) right: f64,
}

impl Span {
    /// An empty interval.
    pub(super) const EMPTY: Self = Self { left: f64::INFINITY, right: f64::NEG_INFINITY };

    /// Pixels whose centres are in the span.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of loops compiled for several processors")]
    fn pixels(self, width: usize) -> (usize, usize) {
        (first_pixel(self.left, width), first_pixel(self.right, width))
    }
}

/// First of `count` pixels whose centre is at or beyond `edge`.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of loops compiled for several processors")]
pub(super) fn first_pixel(edge: f64, count: usize) -> usize {
    // The conversion truncates towards zero and saturates; with the clamp before it, it rounds up.
    let shifted = (edge - 0.5).clamp(0.0, count as f64);
    let whole = shifted as usize;
    whole + usize::from((whole as f64) < shifted)
}

/// The whole part of a number from 0 to 2²³, by its bits: the compiler does that for many numbers at once, but
/// not the conversion, for which a number might be out of range.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of loops compiled for several processors")]
pub(super) fn whole(number: f32) -> u32 {
    /// The number from which on the bits of a fraction are those of a whole number.
    const WHOLE: f32 = 8_388_608.0;
    (number.floor() + WHOLE).to_bits() - WHOLE.to_bits()
}

/// A linear function on the picture: its value at the centre of pixel (0, 0) and its increments per column
/// and row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slope {
    pub(super) origin: f64,
    pub(super) column: f64,
    pub(super) row: f64,
}

impl Slope {
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "part of loops compiled for several processors")]
    pub(super) fn at(&self, column: usize, row: usize) -> f64 {
        self.origin + self.column * column as f64 + self.row * row as f64
    }
}

impl Canvas {
    /// Sets the size of the canvas and clears the depths; colours are not cleared.
    pub(super) fn reset(&mut self, width: usize, height: usize) {
        (self.width, self.height) = (width, height);
        self.colours.resize(width * height, 0);
        self.nearness.clear();
        self.nearness.resize(width * height, 0.0);
    }

    /// Draws a flat shape in one colour with the depth test. Its spans begin at row `top`.
    pub(super) fn fill(&mut self, top: usize, spans: &[Span], nearness: &Slope, colour: Packed) {
        fill(self, top, spans, nearness, colour);
    }

    /// Blends a colour over a shape on the floor, before anything stands on it.
    pub(super) fn tint(&mut self, top: usize, spans: &[Span], colour: Packed, alpha: u8) {
        for (row, span) in (top..).zip(spans) {
            let (from, to) = span.pixels(self.width);
            let start = row * self.width;
            for below in self.colours[start..start + self.width].get_mut(from..to).unwrap_or_default() {
                *below = mix(*below, colour, alpha);
            }
        }
    }

    /// Like [`tint`](Self::tint), but only where the shape is nearest.
    pub(super) fn tint_seen(
        &mut self,
        top: usize,
        spans: &[Span],
        nearness: &Slope,
        (colour, alpha): (Packed, u8),
    ) {
        for (row, span) in (top..).zip(spans) {
            let (from, to) = span.pixels(self.width);
            for column in from..to {
                let at = row * self.width + column;
                if nearness.at(column, row) as f32 > self.nearness[at] {
                    self.colours[at] = mix(self.colours[at], colour, alpha);
                }
            }
        }
    }
}

/// Blend of one colour over another.
fn mix(below: Packed, above: Packed, alpha: u8) -> Packed {
    let alpha = u32::from(alpha);
    let channel = |shift: u32| {
        let (a, b) = ((below >> shift) & 255, (above >> shift) & 255);
        ((a * (255 - alpha) + b * alpha + 127) / 255) << shift
    };
    channel(16) | channel(8) | channel(0)
}

#[multiversion::multiversion(targets(
    "x86_64+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx2+bmi1+bmi2",
    "x86_64+ssse3+sse4.1",
))]
fn fill(canvas: &mut Canvas, top: usize, spans: &[Span], nearness: &Slope, colour: Packed) {
    let width = canvas.width;
    let step = nearness.column as f32;
    for (row, span) in (top..).zip(spans) {
        let (from, to) = span.pixels(width);
        if from >= to {
            continue;
        }
        let near = &mut canvas.nearness[row * width..][from..to];
        let colours = &mut canvas.colours[row * width..][from..to];
        let first = nearness.at(from, row) as f32;
        for ((i, near), old) in (0_u32..).zip(near).zip(colours) {
            let here = first + step * i as f32;
            let in_front = here > *near;
            *near = if in_front { here } else { *near };
            *old = if in_front { colour } else { *old };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_covers_the_pixels_whose_middles_it_holds() {
        let pixels = |left, right| Span { left, right }.pixels(10);
        assert_eq!(pixels(0.0, 10.0), (0, 10));
        assert_eq!(pixels(2.5, 3.5), (2, 3));
        assert_eq!(pixels(2.6, 3.6), (3, 4));
        assert_eq!(pixels(-1e30, 1e30), (0, 10));
        assert_eq!(pixels(f64::INFINITY, f64::NEG_INFINITY), (10, 0));
    }

    #[test]
    fn the_nearer_shape_stays_whatever_the_order() {
        let level = |value| Slope { origin: value, column: 0.0, row: 0.0 };
        let whole = [Span { left: 0.0, right: 4.0 }];
        for order in [[(1.0, 5), (2.0, 7)], [(2.0, 7), (1.0, 5)]] {
            let mut canvas = Canvas::default();
            canvas.reset(4, 1);
            for (near, colour) in order {
                canvas.fill(0, &whole, &level(near), colour);
            }
            assert_eq!(canvas.colours, [7; 4]);
        }
    }

    #[test]
    fn colours_mix_by_their_alpha() {
        assert_eq!(mix(0x10_20_30, 0xff_00_80, 0), 0x10_20_30);
        assert_eq!(mix(0x10_20_30, 0xff_00_80, 255), 0xff_00_80);
        assert_eq!(mix(0, 0xff_ff_ff, 51), 0x33_33_33);
    }
}
