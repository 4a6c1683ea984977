use roverlab::geometry::math;
use roverlab::random::Stream;
use roverlab::vision::signs::Area;

use super::Marked;
use super::faces::{Face, Faces};

/// Size of the pictures (pixels), and their focal length, of a lens of 60 degrees.
const SIZE: (usize, usize) = (320, 240);
const FOCAL: f64 = 277.0;
/// Distances of a sign (m).
const DISTANCES: [f64; 2] = [0.4, 1.5];
/// Largest turn of a sign about its post (degrees).
const TURN: f64 = 35.0;
/// Light, relative to the usual one.
const LIGHT: [f64; 2] = [0.3, 1.5];
/// Longest motion of the camera while a picture is taken (pixels).
const BLUR: f64 = 3.0;
/// Samples of a pixel, each way.
const SAMPLES: usize = 3;
/// Size from which a sign has to be found (pixels).
pub(super) const LEAST: f64 = 20.0;

/// Pictures with a face each, in turn, and some without.
pub(super) fn drawn(faces: Faces, pictures: u32, seed: u64, purpose: &str) -> Vec<Marked> {
    let stream = Stream::new(seed);
    (0..pictures).map(|index| frame(faces, index, &mut stream.child(purpose, index.into()))).collect()
}

/// A sign in the ground of a picture.
struct Sign {
    face: &'static Face,
    area: Area,
}

fn frame(faces: Faces, index: u32, stream: &mut Stream) -> Marked {
    // After one of each face there is an empty one.
    let face = faces.all().get(index as usize % (faces.all().len() + 1));
    let sign = face.map(|face| placed(face, stream));
    let ground = Ground::new(stream);
    let light = stream.between(LIGHT[0], LIGHT[1]);
    let blur = stream.between(0.0, BLUR);
    let mut pixels = Vec::with_capacity(3 * SIZE.0 * SIZE.1);
    for y in 0..SIZE.1 {
        for x in 0..SIZE.0 {
            let mut sums = [0.0; 3];
            for sample in 0..SAMPLES * SAMPLES {
                let part = |of: usize| (of as f64 + 0.5) / SAMPLES as f64;
                let across = part(sample % SAMPLES);
                // The camera moves while it looks.
                let at = (x as f64 + across + blur * (across - 0.5), y as f64 + part(sample / SAMPLES));
                let colour =
                    sign.as_ref().and_then(|sign| sign.colour(at)).unwrap_or_else(|| ground.colour(at));
                sums.iter_mut().zip(colour).for_each(|(sum, part)| *sum += part);
            }
            pixels.extend(sums.map(|sum| {
                let noise = 0.015 * stream.normal();
                (255.0 * (light * sum / (SAMPLES * SAMPLES) as f64 + noise)).clamp(0.0, 255.0) as u8
            }));
        }
    }
    let signs = sign.map_or_else(Vec::new, |sign| sign.marks(faces.class(sign.face)));
    Marked { name: format!("picture {index}"), pixels, size: SIZE, signs }
}

fn placed(face: &'static Face, stream: &mut Stream) -> Sign {
    let height = FOCAL * face.size.1 / stream.between(DISTANCES[0], DISTANCES[1]);
    let width = height * (face.size.0 / face.size.1) * math::cos(stream.between(-TURN, TURN).to_radians());
    let left = stream.between(0.0, SIZE.0 as f64 - width);
    let top = stream.between(0.0, SIZE.1 as f64 - height);
    Sign { face, area: Area::new(left, top, width, height) }
}

impl Sign {
    fn colour(&self, (x, y): (f64, f64)) -> Option<[f64; 3]> {
        let place = ((x - self.area.left) / self.area.width, (y - self.area.top) / self.area.height);
        let inside = (0.0..1.0).contains(&place.0) && (0.0..1.0).contains(&place.1);
        if inside { (self.face.colour)(place) } else { None }
    }

    /// The class and areas of its parts.
    fn marks(&self, class: usize) -> Vec<(usize, Area)> {
        let width = self.area.width / self.face.parts as f64;
        let left = |part: usize| self.area.left + part as f64 * width;
        let area = |part| Area { left: left(part), width, ..self.area };
        (0..self.face.parts).map(|part| (class, area(part))).collect()
    }
}

/// A wall above a floor, with things before them.
struct Ground {
    horizon: f64,
    wall: [f64; 3],
    floor: [f64; 3],
    things: Vec<(Area, [f64; 3])>,
}

impl Ground {
    fn new(stream: &mut Stream) -> Self {
        /// Most things in a picture.
        const THINGS: usize = 12;
        let colour = |stream: &mut Stream| std::array::from_fn(|_| stream.between(0.05, 0.9));
        let thing = |stream: &mut Stream| {
            let [left, width] = [stream.between(-20.0, SIZE.0 as f64), stream.between(4.0, 70.0)];
            let [top, height] = [stream.between(-20.0, SIZE.1 as f64), stream.between(4.0, 70.0)];
            (Area::new(left, top, width, height), colour(stream))
        };
        let things = (0..stream.below(THINGS + 1)).map(|_| thing(stream)).collect();
        let (wall, floor) = (stream.between(0.3, 0.9), stream.between(0.05, 0.4));
        Self { horizon: stream.between(60.0, 160.0), wall: [wall; 3], floor: [floor; 3], things }
    }

    fn colour(&self, (x, y): (f64, f64)) -> [f64; 3] {
        let is_on = |(area, _): &&(Area, [f64; 3])| {
            (area.left..area.left + area.width).contains(&x)
                && (area.top..area.top + area.height).contains(&y)
        };
        let behind = if y < self.horizon { self.wall } else { self.floor };
        self.things.iter().rev().find(is_on).map_or(behind, |(_, colour)| *colour)
    }
}
