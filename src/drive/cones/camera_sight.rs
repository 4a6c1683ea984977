use image::RgbImage;

use super::cone::ConeColour;
use super::sight::Sighting;
use crate::geometry::{Point, math};
use crate::vision::{Components, GrayView, Hsi, rgb_to_hsi};

/// Where a camera is on a car, and how it looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraMount {
    /// Metres from the car's origin.
    pub forward: f64,
    /// Metres above the ground.
    pub height: f64,
    /// Radians by which it looks down.
    pub pitch: f64,
    /// Radians from the left to the right edge of an image.
    pub field_of_view: f64,
}

impl Default for CameraMount {
    /// That of the simulated racing car.
    fn default() -> Self {
        Self { forward: 0.6, height: 1.1, pitch: 0.16, field_of_view: 1.75 }
    }
}

/// Finds cones in images by their colours: hue, saturation and intensity tell blue, yellow and orange from the ground, connected
/// pixels are a cone, and its lowest row says how far off it is on flat ground.
#[derive(Debug, Clone, Default)]
pub struct CameraSight {
    mount: CameraMount,
    components: Components,
    mask: Vec<u8>,
}

/// Hues in 255ths of a turn, from and to.
const HUES: [(ConeColour, u8, u8); 3] =
    [(ConeColour::Orange, 10, 27), (ConeColour::Yellow, 28, 52), (ConeColour::Blue, 140, 185)];
const LEAST_SATURATION: u8 = 90;
const LEAST_PIXELS: usize = 6;
/// Metres beyond which a pixel is too many metres.
const FARTHEST: f64 = 14.0;

/// Metres from the camera between which it finds the colours of nearly all cones, and radians at the edge of an image in which it
/// may not.
const CERTAIN: (f64, f64) = (2.5, 11.0);
const AT_EDGE: f64 = 0.08;

/// The colour of a pixel, if it is that of a cone.
fn class(pixel: [u8; 3]) -> Option<usize> {
    // Most of an image is gray: told without the root that a hue takes.
    let (most, least) = (*pixel.iter().max()?, *pixel.iter().min()?);
    if most - least < 50 {
        return None;
    }
    let Hsi { hue, saturation, .. } = rgb_to_hsi(pixel);
    if saturation < LEAST_SATURATION {
        return None;
    }
    HUES.iter().position(|(_, from, to)| (*from..=*to).contains(&hue))
}

impl CameraSight {
    /// A finder for a camera.
    pub fn new(mount: CameraMount) -> Self {
        Self { mount, ..Self::default() }
    }

    /// The cones in an image, in the car's frame.
    pub fn find(&mut self, image: &RgbImage) -> Vec<Sighting> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        let mut found = Vec::new();
        if width == 0 || height == 0 {
            return found;
        }
        let classes: Vec<Option<usize>> = image.pixels().map(|pixel| class(pixel.0)).collect();
        for (index, (colour, ..)) in HUES.iter().enumerate() {
            self.mask.clear();
            self.mask.extend(classes.iter().map(|class| u8::from(*class == Some(index)) * 255));
            let Ok(view) = GrayView::new(&self.mask, width, height) else { continue };
            for blob in self.components.find(view, LEAST_PIXELS) {
                // What is cut off below has no foot to measure.
                if blob.max.1 + 2 >= height {
                    continue;
                }
                let column = 0.5 * (blob.min.0 + blob.max.0 + 1) as f64;
                let row = (blob.max.1 + 1) as f64;
                found.extend(self.mount.place(column, row, width as f64, height as f64).map(
                    |(position, range, error)| {
                        let size = (blob.max.0 - blob.min.0) as f64 * range / self.mount.focal(width as f64);
                        Sighting { position, size, confidence: 1.0, range, error, colour: *colour }
                    },
                ));
            }
        }
        found
    }
}

impl CameraMount {
    /// Whether a cone at a place in the car's frame is near enough, and far enough within the image, for its colour to be found for
    /// certain.
    pub fn tells_colour_at(&self, place: Point) -> bool {
        let (ahead, left) = (place.x - self.forward, place.y);
        let (range, bearing) = (math::hypot(ahead, left), math::atan2(left, ahead));
        (CERTAIN.0..CERTAIN.1).contains(&range) && bearing.abs() < 0.5 * self.field_of_view - AT_EDGE
    }

    /// Pixels for a tangent of one.
    fn focal(&self, width: f64) -> f64 {
        0.5 * width / math::tan(0.5 * self.field_of_view)
    }

    /// The place on the ground that a pixel shows, its distance from the camera, and how far a pixel more is.
    fn place(&self, column: f64, row: f64, width: f64, height: f64) -> Option<(Point, f64, f64)> {
        let focal = self.focal(width);
        let (sin, cos) = math::sin_cos(self.pitch);
        let ground = |row: f64| {
            let above = (0.5 * height - row) / focal;
            let falls = sin - above * cos;
            (falls > 1e-3).then(|| {
                let depth = self.height / falls;
                (depth * (cos + above * sin), depth)
            })
        };
        let (ahead, depth) = ground(row)?;
        let left = depth * (0.5 * width - column) / focal;
        let range = math::hypot(ahead, left);
        if range > FARTHEST {
            return None;
        }
        let next = ground(row - 1.0).map_or(range, |(farther, _)| farther - ahead);
        Some((Point::new(self.forward + ahead, left), range, 0.03 + 0.5 * next))
    }
}

/// What lidar and camera see together: places by the lidar, colours by the camera where both see something in the same
/// direction. Where the camera would show a cone's colour and does not, the confidence is 0: what stands there is no cone.
pub fn fuse(lidar: &[Sighting], camera: &[Sighting], mount: &CameraMount) -> Vec<Sighting> {
    let bearing = |sighting: &Sighting| math::atan2(sighting.position.y, sighting.position.x);
    lidar
        .iter()
        .map(|seen| {
            let near = camera.iter().filter(|other| {
                let apart = (bearing(seen) - bearing(other)).abs();
                apart < 0.03 && (seen.position - other.position).norm() < 0.4 + 3.0 * other.error
            });
            let best = near.min_by(|a, b| {
                let away = |other: &Sighting| (seen.position - other.position).norm();
                away(a).total_cmp(&away(b))
            });
            match best {
                Some(other) => Sighting { colour: other.colour, ..*seen },
                None if mount.tells_colour_at(seen.position) => Sighting { confidence: 0.0, ..*seen },
                None => *seen,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Pose};
    use crate::io::sim::NoiseModel;
    use crate::io::sim::race::{Race, RaceCarSpec, RaceCone, RaceOptions};
    use crate::io::{Camera, Resolution};
    use crate::world::Colour;

    #[test]
    fn cones_are_found_in_place_and_colour() {
        let painted = [
            (Point::new(5.0, 1.5), 0x1f_4f_d8, ConeColour::Blue),
            (Point::new(5.5, -1.5), 0xf2_c8_11, ConeColour::Yellow),
            (Point::new(9.0, 0.5), 0xf0_70_10, ConeColour::Orange),
        ];
        let cones: Vec<RaceCone> =
            painted.iter().map(|(place, paint, _)| RaceCone::new(*place, Colour::from_hex(*paint))).collect();
        for noise in [0.0, 1.0] {
            let options = RaceOptions { noise: NoiseModel::real().scaled(noise), ..RaceOptions::default() };
            let mut race = Race::new(&cones, &[(RaceCarSpec::default(), Pose::default())], options).unwrap();
            let mut car = race.car(0).unwrap();
            car.set_resolution(Resolution::Vga).unwrap();
            let found = CameraSight::new(CameraMount::default()).find(&car.image().unwrap());
            assert_eq!(found.len(), 3, "{found:?}");
            for (place, _, colour) in painted {
                let seen = found.iter().find(|seen| seen.colour == colour).unwrap();
                let away = (seen.position - place).norm();
                assert!(away < 3.0 * seen.error && seen.is_cone(), "{colour:?}: {away} m off, {seen:?}");
            }
        }
    }

    #[test]
    fn colours_come_to_the_places_of_the_lidar() {
        let at = |x, y, error, colour| {
            let position = Point::new(x, y);
            Sighting { position, size: 0.1, confidence: 1.0, range: position.coords.norm(), error, colour }
        };
        let lidar = [at(5.0, 1.0, 0.03, ConeColour::Unknown), at(5.0, -1.0, 0.03, ConeColour::Unknown)];
        let camera = [at(5.3, 1.05, 0.2, ConeColour::Blue), at(9.0, -1.8, 0.3, ConeColour::Yellow)];
        let both = fuse(&lidar, &camera, &CameraMount::default());
        assert_eq!(
            both.iter().map(|seen| seen.colour).collect::<Vec<_>>(),
            [ConeColour::Blue, ConeColour::Unknown]
        );
        assert_eq!(both[0].position, lidar[0].position);
    }

    #[test]
    fn what_a_camera_would_show_and_does_not_is_no_cone() {
        let confidence = |x: f64, y: f64| {
            let position = Point::new(x, y);
            let (range, colour) = (position.coords.norm(), ConeColour::Unknown);
            let seen = Sighting { position, size: 0.1, confidence: 0.7, range, error: 0.03, colour };
            fuse(&[seen], &[], &CameraMount::default())[0].confidence
        };
        assert!(confidence(5.0, 1.0) < 1e-9 && confidence(9.0, -6.0) < 1e-9);
        // Beyond where it tells colours, beside its image, and below it.
        for (x, y) in [(13.0, 1.0), (3.0, 4.0), (2.5, 0.0)] {
            assert!(confidence(x, y) > 0.6, "{x} {y}");
        }
    }

    #[test]
    fn an_empty_image_shows_nothing() {
        assert!(CameraSight::default().find(&RgbImage::default()).is_empty());
    }
}
