use image::RgbImage;

use super::cone::ConeColour;
use super::sight::ConeSighting;
use crate::geometry::{Point, math};
use crate::vision::{Components, GrayView, Hsi, rgb_to_hsi};

/// Pose and field of view of a camera on a car.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraMount {
    /// Distance ahead of the car's origin (m).
    pub forward: f64,
    /// Height above the ground (m).
    pub height: f64,
    /// Downward pitch (rad).
    pub pitch: f64,
    /// Horizontal field of view (rad).
    pub field_of_view: f64,
}

impl Default for CameraMount {
    /// The camera of the simulated racing car.
    fn default() -> Self {
        Self { forward: 0.6, height: 1.1, pitch: 0.16, field_of_view: 1.75 }
    }
}

/// Detects cones in images by colour. Hue, saturation and intensity separate blue, yellow and orange from the
/// ground; connected pixels form a cone; its lowest row gives the distance on flat ground.
///
/// ```
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::io::{Camera, Resolution};
/// use roverlab::race::{CameraMount, CameraSight, Cone, ConeColour, ConeTrack};
/// let cone = Cone::new(Point::new(6.0, 1.5), ConeColour::Blue);
/// let track = ConeTrack { cones: vec![cone], ..ConeTrack::default() };
/// let simulation = Simulation::new(&track.scene(&[Pose::default()]), SimOptions::ideal())?;
/// let mut car = simulation.robot(0)?;
/// car.set_resolution(Resolution::Vga)?;
/// let seen = CameraSight::new(CameraMount::default()).find(&car.image()?);
/// assert_eq!((seen.len(), seen[0].colour), (1, ConeColour::Blue));
/// assert!((seen[0].position - cone.position).norm() < 0.5, "6 m ahead, to half a metre");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct CameraSight {
    mount: CameraMount,
    components: Components,
    mask: Vec<u8>,
    /// Width and height of the last image (pixels).
    size: [f64; 2],
}

/// Ranges of hue (255ths of a turn).
const HUES: [(ConeColour, u8, u8); 3] =
    [(ConeColour::Orange, 10, 27), (ConeColour::Yellow, 28, 52), (ConeColour::Blue, 140, 185)];
/// Minimum saturation of a cone's pixels (of 255).
const LEAST_SATURATION: u8 = 90;
/// Minimum number of pixels of one colour in a cone.
const LEAST_PIXELS: usize = 6;
/// Difference between the channels of grey ground that noise causes (levels).
const GROUND_CHROMA: u8 = 10;
/// Maximum length of ground that one image row may cover (m): the racing car's camera reaches it at 14 m with
/// 640 columns, and at 20 m with 1296.
const COARSEST: f64 = 2.0 / 3.0;

/// Distance within which the colours of nearly all cones of sufficient size in the image are found (m).
const CERTAIN: f64 = 11.0;
/// Width and height of the coloured part of a cone (m).
const CONE: [f64; 2] = [0.12, 0.3];
/// Width of the image border at which a cone may be cut off (fraction of its width and height).
const BORDER: f64 = 0.05;

/// Index of the cone colour of a pixel, if it has one.
fn class(pixel: [u8; 3]) -> Option<usize> {
    // Most pixels are gray: reject them before the costly hue.
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

/// Colourfulness of a pixel, above the noise of the ground.
fn chroma(image: &RgbImage, column: usize, row: usize) -> f64 {
    let [red, green, blue] = image.get_pixel(column as u32, row as u32).0;
    let (most, least) = (red.max(green).max(blue), red.min(green).min(blue));
    f64::from((most - least).saturating_sub(GROUND_CHROMA))
}

/// Lower end of a cone, with sub-pixel resolution: pixels below its inside count by their relative
/// colourfulness. The result is independent of brightness and blur.
fn foot(image: &RgbImage, top: usize, [column, last]: [usize; 2]) -> f64 {
    let inside = last.saturating_sub(2).max(top);
    let whole = chroma(image, column, inside).max(1.0);
    let below = (inside + 1)..(last + 4).min(image.height() as usize);
    let shares = below.map(|row| (chroma(image, column, row) / whole).min(1.0));
    (inside + 1) as f64 + shares.sum::<f64>()
}

impl CameraSight {
    /// A detector for a camera.
    pub fn new(mount: CameraMount) -> Self {
        Self { mount, ..Self::default() }
    }

    /// Cones in an image, in the car frame.
    pub fn find(&mut self, image: &RgbImage) -> Vec<ConeSighting> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        let mut found = Vec::new();
        self.size = [width as f64, height as f64];
        if width == 0 || height == 0 {
            return found;
        }
        let classes: Vec<Option<usize>> = image.pixels().map(|pixel| class(pixel.0)).collect();
        for (index, (colour, ..)) in HUES.iter().enumerate() {
            self.mask.clear();
            self.mask.extend(classes.iter().map(|class| u8::from(*class == Some(index)) * 255));
            let Ok(view) = GrayView::new(&self.mask, width, height) else { continue };
            for blob in self.components.find(view, LEAST_PIXELS) {
                // A cone cut off at the bottom has no measurable foot.
                if blob.max.1 + 2 >= height {
                    continue;
                }
                let column = 0.5 * (blob.min.0 + blob.max.0 + 1) as f64;
                let row = foot(image, blob.min.1, [usize::midpoint(blob.min.0, blob.max.0), blob.max.1]);
                found.extend(self.mount.place(column, row, width as f64, height as f64).map(
                    |(position, range, error)| {
                        let size = (blob.max.0 - blob.min.0) as f64 * range / self.mount.focal(width as f64);
                        ConeSighting { position, size, confidence: 1.0, range, error, colour: *colour }
                    },
                ));
            }
        }
        found
    }

    /// Fuses lidar and camera: positions from the lidar, colours from the [detections](Self::find) in the
    /// last image in the same direction.
    ///
    /// A lidar detection that should be large in the image but has no cone colour there gets a confidence of
    /// 0: it is most likely not a cone. This applies only if the image shows colours for at least as many
    /// others; a blind or late camera shows none.
    pub fn fuse(&self, lidar: &[ConeSighting], found: &[ConeSighting]) -> Vec<ConeSighting> {
        let colour = |seen: &ConeSighting| ConeSighting { colour: colour_of(seen, found), ..*seen };
        let mut fused: Vec<ConeSighting> = lidar.iter().map(colour).collect();
        let is_pale =
            |seen: &ConeSighting| seen.colour == ConeColour::Unknown && self.would_show(seen.position);
        let painted = fused.iter().filter(|seen| seen.colour != ConeColour::Unknown).count();
        if painted >= fused.iter().filter(|seen| is_pale(seen)).count() {
            fused.iter_mut().filter(|seen| is_pale(seen)).for_each(|seen| seen.confidence = 0.0);
        }
        fused
    }

    /// Whether a cone at a position in the car frame would be large enough, and completely inside the last
    /// image, for its colour to be detected reliably.
    fn would_show(&self, place: Point) -> bool {
        let [width, height] = self.size;
        let Some([column, row, depth]) = self.mount.project(place, self.size) else { return false };
        let scale = self.mount.focal(width) / depth;
        let within = |at: f64, size: f64| (BORDER * size..(1.0 - BORDER) * size).contains(&at);
        // Twice the pixels that make a cone are enough for most of them.
        depth < CERTAIN
            && CONE[0] * CONE[1] * scale * scale > 2.0 * LEAST_PIXELS as f64
            && within(column, width)
            && within(row, height)
            && within(row - CONE[1] * scale, height)
    }
}

/// Colour of the camera detection that matches a lidar detection.
fn colour_of(seen: &ConeSighting, found: &[ConeSighting]) -> ConeColour {
    let bearing = |sighting: &ConeSighting| math::atan2(sighting.position.y, sighting.position.x);
    let away = |other: &ConeSighting| (seen.position - other.position).norm();
    let near = found.iter().filter(|other| {
        (bearing(seen) - bearing(other)).abs() < 0.03 && away(other) < 0.4 + 3.0 * other.error
    });
    near.min_by(|a, b| away(a).total_cmp(&away(b))).map_or(ConeColour::Unknown, |other| other.colour)
}

impl CameraMount {
    /// Focal length (pixels).
    fn focal(&self, width: f64) -> f64 {
        0.5 * width / math::tan(0.5 * self.field_of_view)
    }

    /// Distance up to which an image row covers a sufficiently short stretch of ground (m).
    fn farthest(&self, width: f64) -> f64 {
        (COARSEST * self.height * self.focal(width)).sqrt()
    }

    /// Column, row and depth (m) of a ground position in an image; `None` behind the image plane.
    fn project(&self, place: Point, [width, height]: [f64; 2]) -> Option<[f64; 3]> {
        let (sin, cos) = math::sin_cos(self.pitch);
        let (ahead, left) = (place.x - self.forward, place.y);
        let (depth, below) = (ahead * cos + self.height * sin, self.height * cos - ahead * sin);
        let scale = self.focal(width) / depth;
        (depth > 1e-3).then_some([0.5 * width - left * scale, 0.5 * height + below * scale, depth])
    }

    /// Centre of the cone whose foot begins at a pixel, its distance from the camera, and the change of
    /// distance per pixel (m).
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
        let (nearer, depth) = ground(row)?;
        let aside = depth * (0.5 * width - column) / focal;
        let edge = math::hypot(nearer, aside);
        if edge > self.farthest(width) {
            return None;
        }
        // An image shows the edge of a cone's foot: a square, whose edge is about as far from its middle as a
        // circle's of its area.
        let foot = ConeColour::Unknown.radius() * std::f64::consts::FRAC_2_SQRT_PI;
        let range = edge + foot;
        let [ahead, left] = [nearer, aside].map(|metres| metres * range / edge.max(foot));
        let next = ground(row - 1.0).map_or(range, |(farther, _)| farther - nearer);
        Some((Point::new(self.forward + ahead, left), range, 0.03 + 0.5 * next))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Pose};
    use crate::io::sim::{SimOptions, SimRobot, Simulation};
    use crate::io::{Camera, Resolution};
    use crate::race::{Cone, ConeTrack};

    /// A detector that has seen an image.
    fn sight() -> CameraSight {
        CameraSight { size: [640.0, 480.0], ..CameraSight::default() }
    }

    /// A car in front of cones.
    fn car_before(cones: &[Cone], noise: f64) -> SimRobot {
        let track = ConeTrack { cones: cones.to_vec(), ..ConeTrack::default() };
        let scene = track.scene(&[Pose::default()]);
        Simulation::new(&scene, SimOptions::with_noise(noise, 1)).unwrap().robot(0).unwrap()
    }

    #[test]
    fn cones_are_found_in_place_and_colour() {
        let cones = [
            Cone::new(Point::new(5.0, 1.5), ConeColour::Blue),
            Cone::new(Point::new(5.5, -1.5), ConeColour::Yellow),
            Cone::new(Point::new(9.0, 0.5), ConeColour::Orange),
        ];
        for noise in [0.0, 1.0] {
            let mut car = car_before(&cones, noise);
            car.set_resolution(Resolution::Vga).unwrap();
            let found = CameraSight::new(CameraMount::default()).find(&car.image().unwrap());
            assert_eq!(found.len(), 3, "{found:?}");
            for Cone { position, colour } in cones {
                let seen = found.iter().find(|seen| seen.colour == colour).unwrap();
                let away = (seen.position - position).norm();
                assert!(away < 3.0 * seen.error && seen.is_cone(), "{colour:?}: {away} m off, {seen:?}");
            }
        }
    }

    #[test]
    fn colours_come_to_the_places_of_the_lidar() {
        let at = |x, y, error, colour| {
            let position = Point::new(x, y);
            ConeSighting {
                position,
                size: 0.1,
                confidence: 1.0,
                range: position.coords.norm(),
                error,
                colour,
            }
        };
        let lidar = [at(5.0, 1.0, 0.03, ConeColour::Unknown), at(5.0, -1.0, 0.03, ConeColour::Unknown)];
        let camera = [at(5.3, 1.05, 0.2, ConeColour::Blue), at(9.0, -1.8, 0.3, ConeColour::Yellow)];
        let both = sight().fuse(&lidar, &camera);
        assert_eq!(
            both.iter().map(|seen| seen.colour).collect::<Vec<_>>(),
            [ConeColour::Blue, ConeColour::Unknown]
        );
        assert_eq!(both[0].position, lidar[0].position);
    }

    #[test]
    fn what_a_camera_would_show_and_does_not_is_no_cone() {
        let at = |x: f64, y: f64, colour| {
            let position = Point::new(x, y);
            let range = position.coords.norm();
            ConeSighting { position, size: 0.1, confidence: 0.7, range, error: 0.03, colour }
        };
        let blue = at(6.0, -3.0, ConeColour::Blue);
        let lidar = |x, y| [at(6.0, -3.0, ConeColour::Unknown), at(x, y, ConeColour::Unknown)];
        let confidence =
            |sight: &CameraSight, x, y, found: &[ConeSighting]| sight.fuse(&lidar(x, y), found)[1].confidence;
        assert!(
            confidence(&sight(), 5.0, 1.0, &[blue]) < 1e-9 && confidence(&sight(), 9.0, -6.0, &[blue]) < 1e-9
        );
        // Too far away, beside the image, and below it.
        for (x, y) in [(13.0, 1.0), (3.0, 4.0), (1.4, 0.0)] {
            assert!(confidence(&sight(), x, y, &[blue]) > 0.6, "{x} {y}");
        }
        // A small image, and one that shows nothing.
        let small = CameraSight { size: [160.0, 120.0], ..sight() };
        assert!(confidence(&small, 8.0, 1.0, &[blue]) > 0.6 && confidence(&small, 3.5, 0.5, &[blue]) < 1e-9);
        assert!(confidence(&sight(), 5.0, 1.0, &[]) > 0.6);
    }

    #[test]
    fn a_place_is_where_its_pixel_is() {
        let mount = CameraMount::default();
        for (x, y) in [(4.0, 1.0), (9.0, -3.0), (6.0, 0.0)] {
            // The near edge of the foot, as seen by the camera.
            let eye = Point::new(mount.forward, 0.0);
            let foot = ConeColour::Unknown.radius() * std::f64::consts::FRAC_2_SQRT_PI;
            let middle = eye + (Point::new(x, y) - eye) * (1.0 + foot / (Point::new(x, y) - eye).norm());
            let [column, row, _] = mount.project(Point::new(x, y), [640.0, 480.0]).unwrap();
            let (place, ..) = mount.place(column, row, 640.0, 480.0).unwrap();
            assert!((place - middle).norm() < 1e-9, "{place}");
        }
        assert_eq!(mount.project(Point::new(-3.0, 0.0), [640.0, 480.0]), None);
    }

    #[test]
    fn finer_images_show_cones_farther_off() {
        let cones = [Cone::new(Point::new(18.0, 1.0), ConeColour::Blue)];
        let mut car = car_before(&cones, 0.0);
        let mut sight = CameraSight::new(CameraMount::default());
        for (resolution, seen) in [(Resolution::Vga, 0), (Resolution::Cam1Mp, 1)] {
            car.set_resolution(resolution).unwrap();
            let found = sight.find(&car.image().unwrap());
            assert_eq!(found.len(), seen, "{resolution:?}");
            let away = |one: &ConeSighting| (one.position - cones[0].position).norm();
            assert!(found.iter().all(|one| away(one) < 3.0 * one.error), "{found:?}");
        }
    }

    #[test]
    fn an_empty_image_shows_nothing() {
        assert!(CameraSight::default().find(&RgbImage::default()).is_empty());
    }
}
