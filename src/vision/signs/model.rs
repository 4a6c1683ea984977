use super::descriptor::SignDescriptor;
use super::detector::WindowWeights;
use super::linear::LinearClassifier;
use super::patch::SignPatch;
use crate::ParameterError;
use crate::parameter::require;
use crate::vision::network::{MapSize, Network};

/// What a [`SignTrainer`](super::SignTrainer) has learned: the names of the classes, and the weights by which
/// a [`SignFinder`](super::SignFinder) works.
#[derive(Debug, Clone, PartialEq)]
pub struct SignModel {
    names: Vec<String>,
    /// A row for each class, and one for none if there are weights of windows.
    pub(super) signs: LinearClassifier,
    pub(super) windows: Option<WindowWeights>,
    /// Tells the classes of what are signs.
    pub(super) network: Option<Network>,
}

impl SignModel {
    /// Fails if there are other numbers of classes and features than names and what is described.
    pub(super) fn new(
        names: Vec<String>,
        signs: LinearClassifier,
        windows: Option<WindowWeights>,
    ) -> Result<Self, ParameterError> {
        let classes = names.len();
        require("number of classes", classes as f64, classes > 0, "at least 1")?;
        signs.require(
            "features of a sign",
            classes + usize::from(windows.is_some()),
            SignDescriptor::FEATURES,
        )?;
        if let Some(windows) = &windows {
            require(
                "classes of windows",
                windows.each.classes() as f64,
                windows.each.classes() == classes,
                format!("{classes}"),
            )?;
        }
        Ok(Self { names, signs, windows, network: None })
    }

    /// With a network that tells the classes of signs, by what a [`SignPatch`] shows; whether something is a
    /// sign is still told by histograms of gradients.
    ///
    /// # Errors
    ///
    /// If the network has another input than a patch, or not a result for each class.
    pub fn with_network(self, network: Network) -> Result<Self, ParameterError> {
        let (input, results) = (network.architecture().input(), network.architecture().outputs());
        let patch = MapSize { height: SignPatch::SIDE, width: SignPatch::SIDE, channels: 3 };
        require("values of the input", input.len() as f64, input == patch, format!("{patch:?}"))?;
        let classes = self.names.len();
        require("number of results", results as f64, results == classes, format!("{classes}"))?;
        Ok(Self { network: Some(network), ..self })
    }

    /// The names of the classes.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Whether it can find signs in images; otherwise it tells the classes of signs whose places are known.
    pub fn finds(&self) -> bool {
        self.windows.is_some()
    }
}

/// Reading and writing, in the format of the crate `safetensors`.
#[cfg(feature = "weights")]
mod file {
    use safetensors::tensor::{Dtype, SafeTensors, TensorView};

    use super::{LinearClassifier, Network, SignModel, WindowWeights};
    use crate::vision::WeightsError;
    use crate::vision::network::ARCHITECTURE;

    /// Key of the classes' names in the file's metadata, separated by line breaks.
    const NAMES: &str = "classes";

    impl SignModel {
        /// The model as a file `.safetensors`: 32-bit tensors `signs`, `windows.any` and `windows.each`, a
        /// row for each class, whose last number is the constant; and if there is a network, its
        /// `architecture` as text, and its tensors as [`Network::to_safetensors`] writes them.
        ///
        /// # Errors
        ///
        /// If a name is too long for the format.
        pub fn to_safetensors(&self) -> Result<Vec<u8>, WeightsError> {
            let mut tensors = vec![("signs", &self.signs)];
            if let Some(windows) = &self.windows {
                tensors.extend([("windows.any", &windows.any), ("windows.each", &windows.each)]);
            }
            let bytes = |classifier: &LinearClassifier| {
                classifier.weights().iter().flat_map(|weight| weight.to_le_bytes()).collect()
            };
            let mut tensors: Vec<_> = tensors
                .into_iter()
                .map(|(name, classifier)| {
                    let shape = vec![classifier.classes(), classifier.features() + 1];
                    (name.to_owned(), Dtype::F32, shape, bytes(classifier))
                })
                .collect();
            if let Some(network) = &self.network {
                let architecture = network.architecture().to_string().into_bytes();
                tensors.push((ARCHITECTURE.to_owned(), Dtype::U8, vec![architecture.len()], architecture));
                tensors.extend(network.to_tensors());
            }
            // A second entry would stand before or after it by chance.
            let about = std::iter::once((NAMES.to_owned(), self.names.join("\n"))).collect();
            let view = |(name, kind, shape, bytes)| Ok((name, TensorView::new(kind, shape, bytes)?));
            let views = tensors.iter().map(|(name, kind, shape, bytes)| {
                view((name.as_str(), *kind, shape.clone(), bytes.as_slice()))
            });
            let views: Vec<_> = views.collect::<Result<_, _>>().map_err(WeightsError::of)?;
            safetensors::serialize(views, Some(about)).map_err(WeightsError::of)
        }

        /// Reads what [`to_safetensors`](Self::to_safetensors) wrote.
        ///
        /// # Errors
        ///
        /// If the file is none of the format, or its weights are not those of a model.
        pub fn from_safetensors(bytes: &[u8]) -> Result<Self, WeightsError> {
            let (_, about) = SafeTensors::read_metadata(bytes).map_err(WeightsError::of)?;
            let names = about.metadata().as_ref().and_then(|about| about.get(NAMES));
            let names =
                names.ok_or_else(|| WeightsError::File(format!("found no {NAMES} in the metadata")))?;
            let file = SafeTensors::deserialize(bytes).map_err(WeightsError::of)?;
            let windows = file.names().iter().any(|name| name.starts_with("windows."));
            let windows = windows.then(|| {
                Ok::<_, WeightsError>(WindowWeights::new(
                    read(&file, "windows.any")?,
                    read(&file, "windows.each")?,
                )?)
            });
            let names = names.split('\n').map(String::from).collect();
            let model = Self::new(names, read(&file, "signs")?, windows.transpose()?)?;
            let Ok(architecture) = file.tensor(ARCHITECTURE) else { return Ok(model) };
            let architecture = String::from_utf8_lossy(architecture.data()).parse()?;
            Ok(model.with_network(Network::from_tensors(architecture, &file)?)?)
        }
    }

    /// A tensor of two dimensions.
    fn read(file: &SafeTensors<'_>, name: &str) -> Result<LinearClassifier, WeightsError> {
        let tensor = file.tensor(name).map_err(WeightsError::of)?;
        let Some(&columns) =
            tensor.shape().get(1).filter(|&&columns| tensor.shape().len() == 2 && columns > 0)
        else {
            return Err(WeightsError::File(format!(
                "{name}: found the shape {:?}; expected classes and weights",
                tensor.shape()
            )));
        };
        if tensor.dtype() != Dtype::F32 {
            return Err(WeightsError::File(format!("{name}: found {:?}; expected F32", tensor.dtype())));
        }
        let (numbers, _) = tensor.data().as_chunks::<4>();
        let weights = numbers.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
        Ok(LinearClassifier::from_weights(weights, columns - 1)?)
    }
}
