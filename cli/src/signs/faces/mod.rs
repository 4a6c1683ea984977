//! Faces of signs that are drawn: sets of them, and what they are drawn with.

mod board;
mod book;
mod caudri;
mod shapes;

/// A set of faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Faces {
    /// The six of the book's model road (section 13.5).
    Book,
    /// Those of the rules of the CAuDri-Challenge: 25 faces of 19 classes.
    Caudri,
}

/// A place on a face, 0 to 1 to the right and downwards.
type Place = (f64, f64);
type Colour = [f64; 3];

const WHITE: Colour = [0.95, 0.95, 0.95];
const BLACK: Colour = [0.06, 0.06, 0.06];
const RED: Colour = [0.75, 0.06, 0.1];
const BLUE: Colour = [0.05, 0.25, 0.65];
const GRAY: Colour = [0.45, 0.45, 0.45];
const YELLOW: Colour = [0.95, 0.75, 0.05];

/// A sign as seen from before it.
#[derive(Debug)]
pub(super) struct Face {
    /// Name of its class. Faces of a class follow each other.
    class: &'static str,
    /// Width and height (m).
    pub size: (f64, f64),
    /// Number of equal signs of the class that it shows side by side.
    pub parts: usize,
    /// The colour at a place; none beside the sign.
    pub colour: fn(Place) -> Option<Colour>,
}

impl Face {
    const fn new(class: &'static str, size: (f64, f64), colour: fn(Place) -> Option<Colour>) -> Self {
        Self { class, size, parts: 1, colour }
    }
}

impl Faces {
    pub(super) fn all(self) -> &'static [Face] {
        match self {
            Self::Book => &book::FACES,
            Self::Caudri => &caudri::FACES,
        }
    }

    /// Names of the classes.
    pub(super) fn names(self) -> Vec<&'static str> {
        let mut names: Vec<_> = self.all().iter().map(|face| face.class).collect();
        names.dedup();
        names
    }

    /// The index of a face's class.
    pub(super) fn class(self, face: &Face) -> usize {
        self.names().iter().position(|name| *name == face.class).expect("a face of this set")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two faces of a class may be alike: numbers of speed zones.
    #[test]
    fn faces_differ_and_fill_their_square() {
        let places = || (0..1600).map(|i| (f64::from(i % 40) / 40.0, f64::from(i / 40) / 40.0));
        for set in [Faces::Book, Faces::Caudri] {
            let drawn: Vec<Vec<Option<Colour>>> =
                set.all().iter().map(|face| places().map(face.colour).collect()).collect();
            for (face, pixels) in set.all().iter().zip(&drawn) {
                assert!(pixels.iter().flatten().count() > 700, "{}", face.class);
                for (other, others) in set.all().iter().zip(&drawn) {
                    let differ = pixels.iter().zip(others).filter(|(a, b)| a != b).count();
                    let same = face.class == other.class;
                    assert!(same || differ > 80, "{}, {}: {differ}", face.class, other.class);
                }
            }
        }
    }

    #[test]
    fn faces_of_a_class_follow_each_other() {
        for (set, classes) in [(Faces::Book, 6), (Faces::Caudri, 19)] {
            let mut names = set.names();
            names.sort_unstable();
            names.dedup();
            assert_eq!((names.len(), set.names().len()), (classes, classes));
        }
    }
}
