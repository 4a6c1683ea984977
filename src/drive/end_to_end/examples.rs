use crate::ParameterError;
use crate::parameter::require;
use crate::vision::network::MapSize;

/// Images as a network sees them, each with the curvature that should be steered there.
#[derive(Debug, Clone, PartialEq)]
pub struct SteeringExamples {
    size: MapSize,
    inputs: Vec<f32>,
    /// Curvatures (1/m).
    curvatures: Vec<f64>,
    /// Number of results of the network that is to learn from them.
    results: usize,
}

impl SteeringExamples {
    /// No examples yet.
    pub fn new(size: MapSize) -> Self {
        Self { size, inputs: Vec::new(), curvatures: Vec::new(), results: 1 }
    }

    /// Number of examples.
    pub fn len(&self) -> usize {
        self.curvatures.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.curvatures.is_empty()
    }

    /// The curvatures (1/m).
    pub fn curvatures(&self) -> &[f64] {
        &self.curvatures
    }

    /// What the network sees in an example.
    ///
    /// # Panics
    ///
    /// If there are not as many examples.
    pub fn input(&self, index: usize) -> &[f32] {
        &self.inputs[index * self.size.len()..][..self.size.len()]
    }

    /// Adds an example.
    pub(super) fn push(&mut self, input: &[f32], curvature: f64) {
        self.inputs.extend_from_slice(input);
        self.curvatures.push(curvature);
    }

    /// Adds other examples.
    ///
    /// # Errors
    ///
    /// If their images have another size.
    pub fn extend(&mut self, others: &Self) -> Result<(), ParameterError> {
        let same = others.size == self.size;
        require("values of an image", others.size.len() as f64, same, "the size of those before")?;
        self.inputs.extend_from_slice(&others.inputs);
        self.curvatures.extend_from_slice(&others.curvatures);
        Ok(())
    }

    /// For a network of a number of results: one for the curvature, several for classes of it.
    #[must_use]
    pub fn for_results(self, results: usize) -> Self {
        Self { results: results.max(1), ..self }
    }
}

#[cfg(feature = "learn")]
impl crate::learn::Examples for SteeringExamples {
    fn count(&self) -> usize {
        self.len()
    }

    fn write(&self, index: usize, _random: &mut crate::random::Stream, input: &mut [f32]) -> f32 {
        input.copy_from_slice(self.input(index));
        super::driver::wanted(self.curvatures[index], self.results)
    }
}
