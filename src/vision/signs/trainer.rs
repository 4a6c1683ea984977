use super::area::Area;
use super::descriptor::SignDescriptor;
use super::detector::{Detector, WindowWeights, best_around, gray_of};
use super::finder::SignFinder;
use super::linear::{LinearClassifier, LinearTraining};
use super::model::SignModel;
use super::patch::SignPatches;
use crate::ParameterError;
use crate::parameter::require;
use crate::random::Stream;
use crate::vision::{GrayView, ImageError, RgbView};

/// Learns to find signs, from pictures in which the areas of signs are known. All signs should be marked:
/// what is not is learned as none.
///
/// ```
/// use roverlab::vision::{RgbView, signs::{Area, SignFinder, SignTrainer}};
/// let picture = |red: bool| if red { [200, 20, 20].repeat(900) } else { [20, 20, 200].repeat(900) };
/// let all = Area::new(0.0, 0.0, 30.0, 30.0);
/// let mut trainer = SignTrainer::new(["red", "blue"])?;
/// for (class, red) in [(0, true), (1, false)] {
///     trainer.add(RgbView::new(&picture(red), 30, 30)?, &[(class, all)])?;
/// }
/// let model = trainer.classifier(1)?;
/// assert!(!model.finds(), "the pictures show nothing but signs");
/// assert_eq!(model.names(), ["red", "blue"]);
/// let mut finder = SignFinder::new(model);
/// assert!(finder.classify(RgbView::new(&picture(true), 30, 30)?, all).is_ok());
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SignTrainer {
    names: Vec<String>,
    pictures: Vec<Picture>,
}

#[derive(Debug, Clone)]
struct Picture {
    pixels: Vec<u8>,
    size: (usize, usize),
    signs: Vec<(usize, Area)>,
}

/// Number of samples of signs that are learned, as many of each class.
const SAMPLES: usize = 20_000;
/// Largest number of copies of a sign for that.
const COPIES: usize = 64;
/// Largest offset of a copy, relative to the sign: half a cell, as of windows.
const ASIDE: f64 = 0.08;
/// Largest change of a copy's size, relative to the sign: half a step of the pyramid, as of windows.
const LARGER: f64 = 0.09;
/// Number of windows of each picture that are learned as none before the first round.
const OTHERS: usize = 12;
/// Largest number of wrong windows of a picture that are learned in each round.
const WRONG: usize = 8;
/// Rounds in which windows are added that were taken for signs.
const ROUNDS: usize = 3;
/// Intersection over union below which a window is none of a sign, but at most a part of one.
const NONE: f64 = 0.5;

impl Picture {
    fn view(&self) -> RgbView<'_> {
        RgbView::new(&self.pixels, self.size.0, self.size.1).expect("pixels of its size")
    }

    fn gray<'a>(&self, gray: &'a mut Vec<u8>) -> Result<GrayView<'a>, ImageError> {
        gray_of(self.view(), gray)?;
        GrayView::new(gray, self.size.0, self.size.1)
    }

    /// Whether an area shows a sign.
    fn shows(&self, area: &Area) -> bool {
        self.signs.iter().any(|(_, sign)| sign.overlap(area) >= NONE)
    }
}

/// Features of samples, and whether or what they are.
#[derive(Default)]
struct Samples {
    features: Vec<f32>,
    labels: Vec<usize>,
}

impl Samples {
    fn push(&mut self, features: &[f32], label: usize) {
        self.features.extend_from_slice(features);
        self.labels.push(label);
    }

    /// With one class alone: those of any.
    fn any(&self, classes: usize) -> Self {
        let labels = self.labels.iter().map(|&label| usize::from(label == classes)).collect();
        Self { features: self.features.clone(), labels }
    }

    fn learn(&self, classes: usize, seed: u64) -> Result<LinearClassifier, ParameterError> {
        LinearClassifier::train(
            &self.features,
            &self.labels,
            classes,
            LinearTraining { seed, ..LinearTraining::default() },
        )
    }
}

impl SignTrainer {
    /// A trainer of classes of these names, without pictures.
    ///
    /// # Errors
    ///
    /// If there are no classes, or more than 1000.
    pub fn new<N: Into<String>>(names: impl IntoIterator<Item = N>) -> Result<Self, ParameterError> {
        let names: Vec<String> = names.into_iter().map(Into::into).collect();
        require("number of classes", names.len() as f64, (1..=1000).contains(&names.len()), "1 to 1000")?;
        Ok(Self { names, pictures: Vec::new() })
    }

    /// Adds a picture, and the classes and areas of all of its signs.
    ///
    /// # Errors
    ///
    /// If there is no such class, or an area is empty or not finite.
    pub fn add(&mut self, picture: RgbView<'_>, signs: &[(usize, Area)]) -> Result<(), ParameterError> {
        let classes = self.names.len();
        for (class, area) in signs {
            require("class", *class as f64, *class < classes, format!("below {classes}"))?;
            area.check()?;
        }
        let pixels = (0..picture.height()).flat_map(|y| picture.row(y)).copied().collect();
        self.pictures.push(Picture { pixels, size: picture.size(), signs: signs.to_vec() });
        Ok(())
    }

    /// Learns the classes of signs alone, where pictures show little else.
    ///
    /// # Errors
    ///
    /// If there are no signs.
    pub fn classifier(&self, seed: u64) -> Result<SignModel, ImageError> {
        let signs = self.signs(&mut Stream::new(seed))?.learn(self.names.len(), seed)?;
        Ok(SignModel::new(self.names.clone(), signs, None)?)
    }

    /// Learns to find signs. Windows that are taken for signs although they are none are learned as well, in
    /// rounds.
    ///
    /// # Errors
    ///
    /// If there are no signs.
    pub fn finder(&self, seed: u64) -> Result<SignModel, ImageError> {
        let stream = Stream::new(seed);
        let mut signs = self.signs(&mut stream.child("signs", 0))?;
        let mut windows = self.windows(&mut stream.child("windows", 0))?;
        self.add_others(&mut windows, &mut signs, &mut stream.child("others", 0))?;
        for _ in 0..ROUNDS {
            let mut finder = SignFinder::new(self.learned(&windows, &signs, seed)?);
            self.add_wrong(&mut windows, &mut signs, &mut finder)?;
        }
        Ok(self.learned(&windows, &signs, seed)?)
    }

    fn learned(&self, windows: &Samples, signs: &Samples, seed: u64) -> Result<SignModel, ParameterError> {
        let classes = self.names.len();
        let any = windows.any(classes).learn(1, seed)?;
        let weights = WindowWeights::new(any, windows.learn(classes, seed)?)?;
        SignModel::new(self.names.clone(), signs.learn(classes + 1, seed)?, Some(weights))
    }

    /// The windows of all signs, with copies.
    fn windows(&self, stream: &mut Stream) -> Result<Samples, ImageError> {
        let copies = self.copies();
        let mut samples = Samples::default();
        let (mut detector, mut gray) = (Detector::default(), Vec::new());
        for picture in &self.pictures {
            let gray = picture.gray(&mut gray)?;
            for (class, area) in &picture.signs {
                for copy in around(*area, copies[*class], stream) {
                    samples.push(detector.describe(gray, copy)?, *class);
                }
            }
        }
        Ok(samples)
    }

    /// Adds areas that show no sign.
    fn add_others(
        &self,
        windows: &mut Samples,
        signs: &mut Samples,
        stream: &mut Stream,
    ) -> Result<(), ImageError> {
        for picture in &self.pictures {
            let areas =
                (0..OTHERS).map(|_| anywhere(picture.size, stream)).filter(|area| !picture.shows(area));
            self.add_none(windows, signs, picture, areas)?;
        }
        Ok(())
    }

    /// Adds areas that a finder looks at in detail, although they show no sign.
    fn add_wrong(
        &self,
        windows: &mut Samples,
        signs: &mut Samples,
        finder: &mut SignFinder,
    ) -> Result<(), ImageError> {
        for picture in &self.pictures {
            let likely =
                best_around(finder.likely(picture.view())?, |candidate| (candidate.area, candidate.score));
            let areas =
                likely.into_iter().map(|candidate| candidate.area).filter(|area| !picture.shows(area));
            self.add_none(windows, signs, picture, areas.take(WRONG))?;
        }
        Ok(())
    }

    fn add_none(
        &self,
        windows: &mut Samples,
        signs: &mut Samples,
        picture: &Picture,
        areas: impl Iterator<Item = Area>,
    ) -> Result<(), ImageError> {
        let (mut detector, mut descriptor) = (Detector::default(), SignDescriptor::default());
        let mut gray = Vec::new();
        let gray = picture.gray(&mut gray)?;
        for area in areas {
            windows.push(detector.describe(gray, area)?, self.names.len());
            signs.push(descriptor.describe(picture.view(), area)?, self.names.len());
        }
        Ok(())
    }

    /// The signs, for a network to learn from; see [`SignModel::with_network`].
    ///
    /// # Errors
    ///
    /// If there are no signs.
    pub fn patches(&self) -> Result<SignPatches, ParameterError> {
        let signs = self
            .pictures
            .iter()
            .flat_map(|picture| picture.signs.iter().map(|(class, area)| (picture.view(), *area, *class)));
        SignPatches::new(signs, self.names.len())
    }

    /// How many copies of a sign of each class are learned.
    fn copies(&self) -> Vec<usize> {
        let mut signs = vec![0; self.names.len()];
        self.pictures.iter().flat_map(|picture| &picture.signs).for_each(|(class, _)| signs[*class] += 1);
        signs
            .into_iter()
            .map(|count| (SAMPLES / self.names.len() / usize::max(count, 1)).clamp(1, COPIES))
            .collect()
    }

    /// The signs of all pictures, with copies.
    fn signs(&self, stream: &mut Stream) -> Result<Samples, ImageError> {
        let copies = self.copies();
        let mut samples = Samples::default();
        let mut descriptor = SignDescriptor::default();
        for picture in &self.pictures {
            for (class, area) in &picture.signs {
                for copy in around(*area, copies[*class], stream) {
                    samples.push(descriptor.describe(picture.view(), copy)?, *class);
                }
            }
        }
        Ok(samples)
    }
}

/// An area, and copies of it somewhat aside.
fn around(area: Area, copies: usize, stream: &mut Stream) -> Vec<Area> {
    let mut copy = || {
        let area = area.scaled(1.0 + stream.between(-LARGER, LARGER));
        let aside = [ASIDE * area.width, ASIDE * area.height].map(|most| stream.between(-most, most));
        Area::new(area.left + aside[0], area.top + aside[1], area.width, area.height)
    };
    std::iter::once(area).chain(std::iter::from_fn(|| Some(copy())).take(copies - 1)).collect()
}

/// A square somewhere in a picture, of any size, small ones oftener.
fn anywhere(size: (usize, usize), stream: &mut Stream) -> Area {
    let (width, height) = (size.0 as f64, size.1 as f64);
    let most = width.min(height);
    let side = most * crate::geometry::math::exp(-stream.between(0.0, 2.5));
    Area::new(stream.between(0.0, width - side), stream.between(0.0, height - side), side, side)
}
