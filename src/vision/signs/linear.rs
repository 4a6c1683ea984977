use crate::ParameterError;
use crate::parameter::{require, require_positive};
use crate::random::Stream;
use crate::vision::dispatch::vectorised;

/// Parameters of [`LinearClassifier::train`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearTraining {
    /// Weight of errors against the length of the weights.
    pub cost: f64,
    /// Number of passes over the samples.
    pub passes: usize,
    /// Seed of their order.
    pub seed: u64,
}

impl Default for LinearTraining {
    fn default() -> Self {
        Self { cost: 1.0, passes: 12, seed: 1 }
    }
}

/// Linear classifier: a score for each class, which is a weighted sum of features.
///
/// It learns a support vector machine for each class against all others, with squared hinge loss, by dual
/// coordinate descent (C.-J. Hsieh et al., "A dual coordinate descent method for large-scale linear SVM",
/// ICML 2008). Sums have a fixed order, so equal samples, parameters and seeds give the same bits on every
/// platform.
///
/// ```
/// use roverlab::vision::signs::{LinearClassifier, LinearTraining};
/// // Two features, three samples of each of two classes.
/// let features = [0.9, 0.1, 1.0, 0.3, 0.8, 0.2, 0.1, 0.7, 0.3, 0.9, 0.2, 1.0];
/// let classifier = LinearClassifier::train(&features, &[0, 0, 0, 1, 1, 1], 2, LinearTraining::default())?;
/// let mut scores = [0.0; 2];
/// classifier.scores(&[0.2, 0.8], &mut scores)?;
/// assert!(scores[1] > 0.0 && scores[0] < 0.0);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LinearClassifier {
    features: usize,
    /// A row for each class: the weights of the features, and that of a constant feature of 1.
    weights: Vec<f32>,
}

impl LinearClassifier {
    /// Learns from samples: their features one after the other, and their classes. Takes passes x samples x
    /// classes x features steps.
    ///
    /// # Errors
    ///
    /// If there are no samples, features or classes, the lengths do not agree, a feature is not finite, or a
    /// parameter is out of range. A label that is not below `classes` is a sample of none of them.
    pub fn train(
        features: &[f32],
        labels: &[usize],
        classes: usize,
        training: LinearTraining,
    ) -> Result<Self, ParameterError> {
        let LinearTraining { cost, passes, seed } = training;
        require_positive("cost", cost)?;
        require("passes", passes as f64, (1..=1000).contains(&passes), "1 to 1000")?;
        require("number of classes", classes as f64, (1..=1000).contains(&classes), "1 to 1000")?;
        require("number of samples", labels.len() as f64, !labels.is_empty(), "at least 1")?;
        let width = features.len() / labels.len();
        let whole = width > 0 && width * labels.len() == features.len();
        require(
            "number of features",
            features.len() as f64,
            whole,
            format!("a multiple of {} samples", labels.len()),
        )?;
        let odd = features.iter().find(|feature| !feature.is_finite());
        require("feature", odd.map_or(0.0, |&odd| f64::from(odd)), odd.is_none(), "a finite number")?;

        let mut weights = vec![0.0_f32; classes * (width + 1)];
        let mut duals = vec![0.0_f32; classes * labels.len()];
        // The loss is squared, which adds a constant to the diagonal of the dual's matrix.
        let diagonal = (0.5 / cost) as f32;
        let samples: Vec<&[f32]> = features.chunks_exact(width).collect();
        let squares: Vec<f32> = samples.iter().map(|sample| dot(sample, sample) + 1.0 + diagonal).collect();
        let mut order: Vec<usize> = (0..samples.len()).collect();
        let mut stream = Stream::new(seed);
        for _ in 0..passes {
            stream.shuffle(&mut order);
            for &index in &order {
                let sample = samples[index];
                let rows = weights.chunks_exact_mut(width + 1).zip(&mut duals[index * classes..][..classes]);
                for (class, (row, dual)) in rows.enumerate() {
                    let sign = if class == labels[index] { 1.0 } else { -1.0 };
                    let (row, bias) = row.split_at_mut(width);
                    let bias = &mut bias[0];
                    let gradient = sign * (dot(row, sample) + *bias) - 1.0 + diagonal * *dual;
                    let before = *dual;
                    *dual = (before - gradient / squares[index]).max(0.0);
                    let change = sign * (*dual - before);
                    if change != 0.0 {
                        add(row, sample, change);
                        *bias += change;
                    }
                }
            }
        }
        Ok(Self { features: width, weights })
    }

    /// Fails unless there are as many classes and features.
    pub(super) fn require(
        &self,
        what: &'static str,
        classes: usize,
        features: usize,
    ) -> Result<(), ParameterError> {
        let found = (self.classes(), self.features);
        let expected = format!("{features} for each of {classes} classes, not of {}", found.0);
        require(what, found.1 as f64, found == (classes, features), expected)
    }

    /// Number of features of a sample.
    pub fn features(&self) -> usize {
        self.features
    }

    /// Number of classes.
    pub fn classes(&self) -> usize {
        self.weights.len() / (self.features + 1)
    }

    /// The weights, a row for each class: those of the features, then the constant.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// The classifier with these rows of weights.
    ///
    /// # Errors
    ///
    /// If these are no whole rows, or a weight is not finite.
    pub fn from_weights(weights: Vec<f32>, features: usize) -> Result<Self, ParameterError> {
        let row = features.checked_add(1).filter(|_| features > 0);
        let whole = !weights.is_empty() && row.is_some_and(|row| weights.len().is_multiple_of(row));
        require(
            "number of weights",
            weights.len() as f64,
            whole,
            format!("rows of {features} and a constant"),
        )?;
        let odd = weights.iter().find(|weight| !weight.is_finite());
        require("weight", odd.map_or(0.0, |&odd| f64::from(odd)), odd.is_none(), "a finite number")?;
        Ok(Self { features, weights })
    }

    /// The score of each class; a positive one speaks for it.
    ///
    /// # Errors
    ///
    /// If there are other numbers of features or classes than it has.
    pub fn scores(&self, features: &[f32], scores: &mut [f32]) -> Result<(), ParameterError> {
        self.require("number of features", scores.len(), features.len())?;
        for (score, row) in scores.iter_mut().zip(self.weights.chunks_exact(self.features + 1)) {
            *score = dot(&row[..self.features], features) + row[self.features];
        }
        Ok(())
    }
}

/// Number of sums that a scalar product is divided into, each of every 16th product.
const LANES: usize = 16;

vectorised! {
    /// Scalar product; the same bits for all processors.
    pub(super) fn dot(a: &[f32], b: &[f32]) -> f32 {
        let mut lanes = [0.0_f32; LANES];
        let (whole, rest) = a.as_chunks::<LANES>();
        let (others, other_rest) = b.as_chunks::<LANES>();
        for (a, b) in whole.iter().zip(others) {
            for i in 0..LANES {
                lanes[i] += a[i] * b[i];
            }
        }
        for (lane, (a, b)) in lanes.iter_mut().zip(rest.iter().zip(other_rest)) {
            *lane += a * b;
        }
        lanes.iter().sum()
    }
}

vectorised! {
    /// Adds a multiple of a vector to another.
    fn add(to: &mut [f32], vector: &[f32], factor: f32) {
        for (to, value) in to.iter_mut().zip(vector) {
            *to += factor * value;
        }
    }
}
