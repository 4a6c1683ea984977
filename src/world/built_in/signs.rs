use image::{Rgba, RgbaImage};

use super::paint::Word;
use crate::geometry::math;
use crate::world::Colour;

/// A traffic sign of the book's model town (section 13.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sign {
    Stop,
    GiveWay,
    Parking,
    NoParking,
    Pedestrian,
    SpeedLimit,
    CancelSpeedLimit,
}

/// Width and height of a sign's picture (pixels).
const SIZE: u32 = 160;
/// Colour of prohibitions and warnings.
const RED: Colour = Colour::from_hex(0xc4_12_1c);
/// Colour of orders and advice.
const BLUE: Colour = Colour::from_hex(0x0b_4d_a2);
/// Colour of end signs.
const GRAY: Colour = Colour::from_hex(0x60_60_60);

impl Sign {
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "StopSign" => Self::Stop,
            "GiveWaySign" => Self::GiveWay,
            "ParkingSign" => Self::Parking,
            "NoParkingSign" => Self::NoParking,
            "PedestrianSign" => Self::Pedestrian,
            "SpeedLimitSign" => Self::SpeedLimit,
            "CancelSpeedLimitSign" => Self::CancelSpeedLimit,
            _ => return None,
        })
    }

    /// The sign's picture; transparent outside.
    pub(super) fn picture(self) -> RgbaImage {
        let words = ["STOP", "P", "30"].map(Word::new);
        drawn(|x, y| self.colour(x, y, &words))
    }

    /// Its outline in white, to be coloured like its back.
    pub(super) fn picture_from_behind(self) -> RgbaImage {
        drawn(|x, y| (self.edge(-x, y) <= 1.0).then_some(Colour::WHITE))
    }

    /// Relative distance of a point from the centre: 1 at the sign's edge.
    fn edge(self, x: f64, y: f64) -> f64 {
        match self {
            Self::Stop => {
                let diagonal = (x.abs() + y.abs()) * std::f64::consts::FRAC_1_SQRT_2;
                x.abs().max(y.abs()).max(diagonal)
            }
            Self::Parking | Self::Pedestrian => x.abs().max(y.abs()),
            Self::GiveWay => triangle(x, y),
            Self::NoParking | Self::SpeedLimit | Self::CancelSpeedLimit => math::hypot(x, y),
        }
    }

    fn colour(self, x: f64, y: f64, [stop, letter, speed]: &[Word; 3]) -> Option<Colour> {
        let edge = self.edge(x, y);
        if edge > 1.0 {
            return None;
        }
        let stroke = |from: f64, to: f64| (from..to).contains(&edge);
        // Diagonal from the lower left to the upper right.
        let bar = |half: f64| (x + y).abs() < half;
        Some(match self {
            Self::Stop if stroke(0.88, 0.96) || stop.covers(x / 0.74, y / 0.3) => Colour::WHITE,
            Self::Parking if letter.covers(x / 0.42, y / 0.62) || stroke(0.9, 0.95) => Colour::WHITE,
            Self::Pedestrian if is_walker(x, y) => Colour::BLACK,
            Self::Pedestrian if triangle(x / 0.8, -y / 0.8 + 0.05) <= 1.0 => Colour::WHITE,
            Self::SpeedLimit if edge <= 0.8 && speed.covers(x / 0.6, y / 0.42) => Colour::BLACK,
            Self::CancelSpeedLimit if edge > 0.94 || (bar(0.28) && (x + y).abs() % 0.14 < 0.08) => {
                Colour::BLACK
            }
            Self::CancelSpeedLimit if speed.covers(x / 0.6, y / 0.42) => GRAY,
            Self::GiveWay if edge > 0.55 => RED,
            Self::NoParking if edge > 0.82 || bar(0.16) => RED,
            Self::SpeedLimit if edge > 0.8 => RED,
            Self::Stop => RED,
            Self::Parking | Self::NoParking | Self::Pedestrian => BLUE,
            Self::GiveWay | Self::SpeedLimit | Self::CancelSpeedLimit => Colour::WHITE,
        })
    }
}

/// An image from the colour at each point, from -1 to 1 across and from -1 at the top to 1 at the bottom.
fn drawn(colour: impl Fn(f64, f64) -> Option<Colour>) -> RgbaImage {
    let place = |pixel: u32| 2.0 * (f64::from(pixel) + 0.5) / f64::from(SIZE) - 1.0;
    RgbaImage::from_fn(SIZE, SIZE, |column, row| match colour(place(column), place(row)) {
        Some(Colour { red, green, blue }) => Rgba([red, green, blue, 255]),
        // Colour of the rim, for filters that mix it in.
        None => Rgba([160, 160, 160, 0]),
    })
}

/// Relative distance of a point in a triangle on its tip: 1 at its edge.
fn triangle(x: f64, y: f64) -> f64 {
    // It is as high as it is wide.
    (2.0 * x.abs() + y).max(-y)
}

/// A walking person in a few strokes.
fn is_walker(x: f64, y: f64) -> bool {
    /// Line segments of the pedestrian, relative to the sign.
    const LIMBS: [([f64; 2], [f64; 2]); 5] = [
        ([0.02, -0.12], [0.0, 0.15]),
        ([0.0, 0.12], [-0.16, 0.44]),
        ([0.0, 0.12], [0.16, 0.44]),
        ([0.02, -0.1], [-0.17, 0.1]),
        ([0.02, -0.1], [0.19, 0.06]),
    ];
    let limb = |[a, b]: [f64; 2], [c, d]: [f64; 2]| {
        let (along, length) = ([c - a, d - b], (c - a) * (c - a) + (d - b) * (d - b));
        let share = (((x - a) * along[0] + (y - b) * along[1]) / length).clamp(0.0, 1.0);
        math::hypot(x - a - share * along[0], y - b - share * along[1]) < 0.055
    };
    math::hypot(x - 0.03, y + 0.26) < 0.09 || LIMBS.iter().any(|&(from, to)| limb(from, to))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fraction of a picture's opaque pixels for which `is_it`.
    fn share(sign: Sign, is_it: impl Fn([u8; 4]) -> bool) -> f64 {
        let picture = sign.picture();
        let seen: Vec<_> = picture.pixels().filter(|pixel| pixel[3] == 255).collect();
        seen.iter().filter(|pixel| is_it(pixel.0)).count() as f64 / seen.len() as f64
    }

    #[test]
    fn signs_have_their_colours() {
        let red = |[r, g, b, _]: [u8; 4]| r > 150 && g < 80 && b < 80;
        let blue = |[r, _, b, _]: [u8; 4]| b > 120 && r < 80;
        let white = |p: [u8; 4]| p[..3].iter().all(|&c| c > 200);
        assert!(share(Sign::Stop, red) > 0.6 && share(Sign::Stop, white) > 0.15);
        assert!(share(Sign::Parking, blue) > 0.6 && share(Sign::Parking, white) > 0.1);
        assert!(share(Sign::NoParking, blue) > 0.3 && share(Sign::NoParking, red) > 0.3);
        assert!(share(Sign::SpeedLimit, white) > 0.4 && share(Sign::SpeedLimit, red) > 0.25);
        assert!(share(Sign::CancelSpeedLimit, red) == 0.0);
        assert!(share(Sign::GiveWay, red) > 0.4 && share(Sign::GiveWay, white) > 0.2);
        assert!(share(Sign::Pedestrian, blue) > 0.3 && share(Sign::Pedestrian, white) > 0.15);
    }

    #[test]
    fn the_back_has_the_outline_of_the_front() {
        for sign in [Sign::Stop, Sign::GiveWay, Sign::SpeedLimit] {
            let (front, back) = (sign.picture(), sign.picture_from_behind());
            let mirrored = |x: u32| SIZE - 1 - x;
            assert!(
                front.enumerate_pixels().all(|(x, y, pixel)| pixel[3] == back.get_pixel(mirrored(x), y)[3])
            );
        }
    }
}
