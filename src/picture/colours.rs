use crate::world::Colour;

/// Colours that distinguish things of one kind, such as several robots: the n-th takes the n-th colour,
/// cyclically. They remain distinguishable with colour blindness.
pub const SERIES: [Colour; 11] = [
    Colour::from_hex(0x1f_6f_b2),
    Colour::from_hex(0x1b_92_7a),
    Colour::from_hex(0xa5_4f_96),
    Colour::from_hex(0xb0_7d_12),
    Colour::from_hex(0xc8_3e_4d),
    Colour::from_hex(0x7a_8b_2a),
    Colour::from_hex(0x3b_9e_c9),
    Colour::from_hex(0x5b_45_9c),
    Colour::from_hex(0xe2_85_2b),
    Colour::from_hex(0x5d_4b_3c),
    Colour::from_hex(0x2b_8a_3e),
];

/// The page: white.
pub(super) const PAGE: Colour = Colour::from_hex(0xff_ff_ff);
/// The floor of a world.
pub(super) const FLOOR: Colour = Colour::from_hex(0xf8_f6_f1);
/// Its water.
pub(super) const WATER: Colour = Colour::from_hex(0xe3_f0_f5);
/// The edge of the floor.
pub(super) const EDGE: Colour = Colour::from_hex(0xd3_cd_be);
/// Walls.
pub(super) const WALL: Colour = Colour::from_hex(0x46_4e_5f);
/// The highest ground.
pub(super) const HILL: Colour = Colour::from_hex(0xb9_a4_7c);
/// Text, and robots' outlines.
pub(super) const INK: Colour = Colour::from_hex(0x26_2d_3a);
/// Captions and scales.
pub(super) const PALE_INK: Colour = Colour::from_hex(0x6d_75_84);
/// Letters that stand in cells of a maze.
pub(super) const LETTER: Colour = Colour::from_hex(0xc2_ba_a8);
/// Where odometry takes a robot to be.
pub(super) const ODOMETRY: Colour = Colour::from_hex(0xe2_85_2b);
/// Goals and starts.
pub(super) const GREEN: Colour = Colour::from_hex(0x2e_8b_57);
/// Contacts, and what went wrong.
pub(super) const RED: Colour = Colour::from_hex(0xc8_3e_4d);
/// Points that sensors have seen.
pub(super) const CLOUD: Colour = Colour::from_hex(0xb8_55_8b);

/// The n-th colour of [`SERIES`], cyclically.
pub(super) fn series(n: usize) -> Colour {
    SERIES[n % SERIES.len()]
}

/// Colour scale for a number between 0 and 1, from deep blue over green and yellow to red. Values outside are
/// clamped.
///
/// ```
/// use roverlab::picture::ramp;
/// assert_ne!(ramp(0.0), ramp(1.0));
/// assert_eq!(ramp(2.0), ramp(1.0), "values beyond the range count as its end");
/// ```
pub fn ramp(value: f64) -> Colour {
    /// The colours of the ramp, from the least value to the greatest.
    const STOPS: [Colour; 5] = [
        Colour::from_hex(0x2f_3e_7e),
        Colour::from_hex(0x23_86_9b),
        Colour::from_hex(0x5d_b0_6a),
        Colour::from_hex(0xf0_b8_3c),
        Colour::from_hex(0xd2_4b_3f),
    ];
    let place = value.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let stop = (place as usize).min(STOPS.len() - 2);
    mix(STOPS[stop], STOPS[stop + 1], place - stop as f64)
}

/// The colour a fraction `share` of the way from `a` to `b`.
pub(super) fn mix(a: Colour, b: Colour, share: f64) -> Colour {
    let channel = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
    Colour::new(channel(a.red, b.red), channel(a.green, b.green), channel(a.blue, b.blue))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ramp_has_ends_and_clamps() {
        assert_eq!(ramp(-1.0), ramp(0.0));
        assert_eq!(ramp(2.0), ramp(1.0));
        assert_ne!(ramp(0.0), ramp(1.0));
        assert_eq!(ramp(0.25), Colour::from_hex(0x23_86_9b));
    }

    #[test]
    fn mixing_keeps_the_ends() {
        let (a, b) = (Colour::new(0, 100, 255), Colour::new(255, 0, 3));
        assert_eq!((mix(a, b, 0.0), mix(a, b, 1.0)), (a, b));
    }
}
