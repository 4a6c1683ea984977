use safetensors::tensor::{Dtype, SafeTensors, TensorView};

use super::trainer::{Trainer, TrainerOptions, TrainingError, numbers, numbers_mut};
use crate::vision::network::Architecture;

/// Names of the tensors: the weights, and the means of gradients and squares.
const TENSORS: [&str; 3] = ["weights", "means", "squares"];
/// Keys of the metadata.
const KEYS: [&str; 4] = ["architecture", "options", "steps", "epochs"];

impl Trainer {
    /// The state between two epochs, as a file `.safetensors`. A trainer that goes on from it ends with the
    /// same weights as one that was never interrupted.
    ///
    /// # Errors
    ///
    /// If it does not fit into the format.
    pub fn to_checkpoint(&self) -> Result<Vec<u8>, TrainingError> {
        let [means, squares] = &self.moments;
        let tensors = TENSORS.iter().zip([&self.weights, means, squares]);
        let bytes: Vec<(&str, Vec<u8>)> = tensors
            .map(|(name, all)| (*name, numbers(all).flat_map(|number| number.to_le_bytes()).collect()))
            .collect();
        let views = bytes.iter().map(|(name, bytes)| {
            Ok((*name, TensorView::new(Dtype::F32, vec![bytes.len() / 4], bytes).map_err(told)?))
        });
        let views: Vec<_> = views.collect::<Result<_, TrainingError>>()?;
        let values = [
            self.architecture.to_string(),
            facts(&self.options),
            self.steps.to_string(),
            self.epochs.to_string(),
        ];
        let about = KEYS.map(String::from).into_iter().zip(values).collect();
        safetensors::serialize(views, Some(about)).map_err(told)
    }

    /// Goes on from a state, with the same options; only the number of threads may be another one.
    ///
    /// # Errors
    ///
    /// If the file is none of the format, or of another architecture or other options.
    pub fn from_checkpoint(
        bytes: &[u8],
        architecture: Architecture,
        options: TrainerOptions,
    ) -> Result<Self, TrainingError> {
        let (_, about) = SafeTensors::read_metadata(bytes).map_err(told)?;
        let about = about.metadata().clone().unwrap_or_default();
        let said = |key: &str| about.get(key).map_or("", String::as_str);
        for (key, expected) in KEYS.iter().zip([architecture.to_string(), facts(&options)]) {
            if said(key) != expected {
                return Err(TrainingError::File(format!(
                    "{key}: found {:?}; expected {expected:?}",
                    said(key)
                )));
            }
        }
        let count = |key: &str| {
            let error = || TrainingError::File(format!("{key}: found {:?}; expected a number", said(key)));
            said(key).parse().map_err(|_| error())
        };
        let mut trainer = Self::new(architecture, options)?;
        (trainer.steps, trainer.epochs) = (count(KEYS[2])?, count(KEYS[3])?);
        let file = SafeTensors::deserialize(bytes).map_err(told)?;
        let [means, squares] = &mut trainer.moments;
        for (name, all) in TENSORS.iter().zip([&mut trainer.weights, means, squares]) {
            let tensor = file.tensor(name).map_err(told)?;
            let (values, _) = tensor.data().as_chunks::<4>();
            let expected = numbers(all).count();
            if tensor.dtype() != Dtype::F32 || values.len() != expected {
                let (kind, found) = (tensor.dtype(), values.len());
                return Err(TrainingError::File(format!(
                    "{name}: found {found} of {kind:?}; expected {expected} of F32"
                )));
            }
            for (number, &value) in numbers_mut(all).zip(values) {
                *number = f32::from_le_bytes(value);
                if !number.is_finite() {
                    return Err(TrainingError::File(format!(
                        "{name}: found {number}; expected finite numbers"
                    )));
                }
            }
        }
        Ok(trainer)
    }
}

/// The options on which the result depends.
fn facts(options: &TrainerOptions) -> String {
    let TrainerOptions { loss, batch, decay, hidden, seed, threads: _ } = options;
    format!("{loss:?}, batch {batch}, decay {decay}, hidden {hidden}, seed {seed}")
}

#[allow(clippy::needless_pass_by_value, reason = "it maps errors")]
fn told(error: safetensors::SafeTensorError) -> TrainingError {
    TrainingError::File(error.to_string())
}
