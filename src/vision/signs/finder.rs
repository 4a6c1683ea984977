use super::area::Area;
use super::descriptor::SignDescriptor;
use super::detector::{Candidate, Detector, best_around, gray_of};
use super::model::SignModel;
use super::patch::SignPatch;
use crate::ParameterError;
use crate::parameter::require_finite;
use crate::vision::{GrayView, ImageError, RgbView};

/// A sign in an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundSign {
    /// Its class.
    pub class: usize,
    /// Where it is.
    pub area: Area,
    /// By how much histograms of gradients take it for a sign rather than none; positive.
    pub score: f32,
}

/// Finds signs in images, and tells their classes, by what a [`SignTrainer`](super::SignTrainer) has learned.
///
/// At each place of a pyramid of images linear classifiers of histograms of gradients say whether there may
/// be a sign; the likely places are described in more detail, colours included, and another classifier says
/// of which class they are, or that they are none. A model's network has the last word on the class.
///
/// ```
/// use roverlab::vision::{RgbView, signs::{Area, SignFinder, SignTrainer}};
/// // Gray pictures, each with a red square: the sign.
/// let picture = |left: usize, top: usize| -> Vec<u8> {
///     let is_sign = |i: usize| (left..left + 24).contains(&(i % 80)) && (top..top + 24).contains(&(i / 80));
///     (0..80 * 60).flat_map(|i| if is_sign(i) { [200, 20, 20] } else { [90, 90, 90] }).collect()
/// };
/// let mut trainer = SignTrainer::new(["square"])?;
/// for (left, top) in [(10, 8), (40, 20), (25, 30), (50, 5)] {
///     let area = Area::new(left as f64, top as f64, 24.0, 24.0);
///     trainer.add(RgbView::new(&picture(left, top), 80, 60)?, &[(0, area)])?;
/// }
/// let mut finder = SignFinder::new(trainer.finder(1)?);
/// let found = finder.find(RgbView::new(&picture(33, 17), 80, 60)?)?;
/// assert!(found.len() == 1 && found[0].area.overlap(&Area::new(33.0, 17.0, 24.0, 24.0)) > 0.5);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SignFinder {
    model: SignModel,
    detector: Detector,
    descriptor: SignDescriptor,
    patch: SignPatch,
    gray: Vec<u8>,
    scores: Vec<f32>,
}

impl SignFinder {
    /// A finder by a model.
    pub fn new(model: SignModel) -> Self {
        let scores = vec![0.0; model.signs.classes()];
        let (detector, descriptor) = (Detector::default(), SignDescriptor::default());
        Self { model, detector, descriptor, patch: SignPatch::default(), gray: Vec::new(), scores }
    }

    /// What it works by.
    pub fn model(&self) -> &SignModel {
        &self.model
    }

    /// The signs in an image, the best first. None of them is a part of another. An image that is smaller
    /// than 24 pixels a side has none.
    ///
    /// # Errors
    ///
    /// If the model cannot find signs.
    pub fn find(&mut self, image: RgbView<'_>) -> Result<Vec<FoundSign>, ImageError> {
        let mut found = Vec::new();
        for candidate in self.likely(image)? {
            let (class, score) = self.by_gradients(image, candidate.area)?;
            let sign = FoundSign { class, area: candidate.area, score: score + candidate.score };
            if sign.score > 0.0 {
                found.push(sign);
            }
        }
        let mut found = best_around(found, |sign| (sign.area, sign.score));
        for sign in &mut found {
            if let Some((class, _)) = self.by_network(image, sign.area)? {
                sign.class = class;
            }
        }
        Ok(found)
    }

    /// Windows that are looked at in detail.
    pub(super) fn likely(&mut self, image: RgbView<'_>) -> Result<Vec<Candidate>, ImageError> {
        let none = || ParameterError::new("number of weights of windows", 0.0, "a model that finds signs");
        let windows = self.model.windows.as_ref().ok_or_else(none)?;
        gray_of(image, &mut self.gray)?;
        let gray = GrayView::new(&self.gray, image.width(), image.height())?;
        self.detector.candidates(gray, windows)
    }

    /// The class that fits what an area shows best, and its score: the result of the model's network, if it
    /// has one, else by how much the class fits better than none, if the model knows what is none.
    ///
    /// # Errors
    ///
    /// If the area is empty, or not finite.
    pub fn classify(&mut self, image: RgbView<'_>, area: Area) -> Result<(usize, f32), ImageError> {
        match self.by_network(image, area)? {
            Some(told) => Ok(told),
            None => self.by_gradients(image, area),
        }
    }

    fn by_network(&mut self, image: RgbView<'_>, area: Area) -> Result<Option<(usize, f32)>, ImageError> {
        let Some(network) = &mut self.model.network else { return Ok(None) };
        let results = network.run(self.patch.read(image, area)?)?;
        for result in results {
            require_finite("result of the network", f64::from(*result))?;
        }
        Ok(Some(best(results)))
    }

    fn by_gradients(&mut self, image: RgbView<'_>, area: Area) -> Result<(usize, f32), ImageError> {
        let features = self.descriptor.describe(image, area)?;
        self.model.signs.scores(features, &mut self.scores)?;
        let (scores, others) = self.scores.split_at(self.model.names().len());
        let none = others.first().copied().unwrap_or_default();
        let (class, score) = best(scores);
        Ok((class, score - none))
    }
}

/// The class with the highest score, and this. A model has a class.
fn best(scores: &[f32]) -> (usize, f32) {
    let class =
        (1..scores.len()).fold(0, |best, class| if scores[class] > scores[best] { class } else { best });
    (class, scores[class])
}
