//! Bodies of finite thickness.

use super::lens::Material;
use super::quantity::{InvalidQuantity, Quantity, Requirement};

/// Support of the back of a [`Layer`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Base {
    /// Bonded to a rigid body, such as glass.
    #[default]
    Rigid,
    /// In frictionless contact with a rigid body, without separation.
    Frictionless,
    /// Bonded to a half-space of this material.
    Elastic(Material),
}

/// A flat layer of infinite extent instead of a half-space. On a rigid support, the approach of the layer to the other body is that of its
/// back.
///
/// ```
/// use fakir::problem::{Base, Layer};
///
/// let film = Layer::new(0.5e-3); // m
/// assert_eq!(film.base, Base::Rigid);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Thickness `t`, m.
    pub thickness: f64,
    /// Support of the back.
    pub base: Base,
}

impl Layer {
    /// A layer of the given thickness (m) bonded to a rigid body.
    #[must_use]
    pub fn new(thickness: f64) -> Self {
        Self {
            thickness,
            base: Base::Rigid,
        }
    }

    /// Checks the thickness, and modulus and Poisson's ratio of the base; `names` are the quantities in errors.
    pub(super) fn check(&self, names: [Quantity; 3]) -> Result<(), InvalidQuantity> {
        let [thickness, modulus, ratio] = names;
        Requirement::Positive.check(thickness, self.thickness)?;
        if let Base::Elastic(base) = self.base {
            Requirement::Positive.check(modulus, base.young_modulus)?;
            Requirement::PoissonRatio.check(ratio, base.poisson_ratio)?;
        }
        Ok(())
    }
}

/// Step of the central differences in [`WeightedLayer::changes`]: relative for lengths and moduli, absolute for Poisson's ratios.
const CHANGE: f64 = 1e-5;

/// A material, and a layer if the body is one.
pub(super) type Body = (Material, Option<Layer>);

/// A layer among the bodies in contact, in some unit of length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WeightedLayer {
    /// Fraction of its material in the contact compliance, `c_b/c`.
    pub(crate) weight: f64,
    pub(crate) thickness: f64,
    pub(crate) poisson_ratio: f64,
    pub(crate) base: LayerBase,
}

/// A base relative to the layer on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LayerBase {
    Frictionless,
    /// Bonded base: shear modulus of the layer divided by that of the base (0 for a rigid base), and Poisson's ratio of the base.
    Bonded {
        shear_ratio: f64,
        poisson_ratio: f64,
    },
}

impl WeightedLayer {
    /// The layers among bodies, with lengths divided by `unit` (m). Half-spaces are omitted.
    pub(crate) fn among(bodies: &[Body], unit: f64) -> Vec<Self> {
        let compliances = bodies.iter().map(|body| body.0.plane_strain_compliance());
        let compliance: f64 = compliances.sum();
        let layered = bodies.iter().filter_map(|(material, layer)| {
            let layer = layer.as_ref()?;
            Some(Self {
                weight: material.plane_strain_compliance() / compliance,
                thickness: layer.thickness / unit,
                poisson_ratio: material.poisson_ratio,
                base: LayerBase::under(material, &layer.base),
            })
        });
        layered.collect()
    }

    /// Layers in another unit of length, given in the previous unit.
    pub(crate) fn in_unit(layers: &[Self], unit: f64) -> Vec<Self> {
        let scaled = |layer: &Self| Self {
            thickness: layer.thickness / unit,
            ..*layer
        };
        layers.iter().map(scaled).collect()
    }

    /// Thickness of the thinnest layer; `None` without layers.
    pub(crate) fn thinnest(layers: &[Self]) -> Option<f64> {
        layers.iter().map(|layer| layer.thickness).reduce(f64::min)
    }

    /// The change of the correction for layers between two states of the same bodies, divided by the difference `width`. The result is
    /// again a set of layers, since the correction is linear in their weights.
    pub(crate) fn change([before, after]: [Vec<Self>; 2], width: f64) -> Vec<Self> {
        let part = |sign: f64| {
            move |layer: Self| Self {
                weight: sign * layer.weight / width,
                ..layer
            }
        };
        let before = before.into_iter().map(part(-1.0));
        before.chain(after.into_iter().map(part(1.0))).collect()
    }

    /// Derivatives of the correction for layers with respect to the quantities on which it depends, of the substrate and of the lens if it is not rigid, in a unit of length (m): by central
    /// differences of the layers themselves, accurate to 1e-9.
    pub(crate) fn changes(bodies: &[Body], unit: f64) -> Vec<(Quantity, Vec<Self>)> {
        use Quantity as Q;
        if bodies.iter().all(|(_, layer)| layer.is_none()) {
            return Vec::new();
        }
        let moduli = [
            [Q::SubstrateYoungModulus, Q::SubstratePoissonRatio],
            [Q::LensYoungModulus, Q::LensPoissonRatio],
        ];
        let names = [Q::SUBSTRATE_LAYER, Q::LENS_LAYER];
        let mut changes = Vec::new();
        for (body, (material, layer)) in bodies.iter().enumerate() {
            let mut add = |quantity, value: Option<f64>, set: &dyn Fn(&mut Body, f64)| {
                let (value, width) = value.map_or((0.0, 1.0), |value| (value, value));
                let at = |by: f64| {
                    let mut bodies = bodies.to_vec();
                    set(&mut bodies[body], value + by * width);
                    Self::among(&bodies, unit)
                };
                let sides = [-CHANGE, CHANGE].map(at);
                changes.push((quantity, Self::change(sides, 2.0 * CHANGE * width)));
            };
            let [young, poisson] = moduli[body];
            add(young, Some(material.young_modulus), &|body, value| {
                body.0.young_modulus = value;
            });
            add(poisson, None, &|body, by| body.0.poisson_ratio += by);
            let Some(layer) = layer else {
                continue;
            };
            let [thickness, young, poisson] = names[body];
            let set = |of: fn(&mut Layer, f64)| {
                move |body: &mut Body, value: f64| {
                    if let Some(layer) = &mut body.1 {
                        of(layer, value);
                    }
                }
            };
            let by_thickness = set(|layer, value| layer.thickness = value);
            add(thickness, Some(layer.thickness), &by_thickness);
            if let Base::Elastic(base) = layer.base {
                let by_young = set(|layer, value| {
                    if let Base::Elastic(base) = &mut layer.base {
                        base.young_modulus = value;
                    }
                });
                add(young, Some(base.young_modulus), &by_young);
                let by_poisson = set(|layer, by| {
                    if let Base::Elastic(base) = &mut layer.base {
                        base.poisson_ratio += by;
                    }
                });
                add(poisson, None, &by_poisson);
            }
        }
        changes
    }

    /// Approach of surface and back under a uniform pressure, for unit contact compliance: `w t (1 - 2 nu)/(1 - nu)^2` for a layer without
    /// lateral expansion, `w t` for one with free lateral expansion.
    pub(crate) fn squeeze(&self) -> f64 {
        let nu = self.poisson_ratio;
        let confined = match self.base {
            LayerBase::Frictionless => 1.0,
            LayerBase::Bonded { .. } => (1.0 - 2.0 * nu) / ((1.0 - nu) * (1.0 - nu)),
        };
        self.weight * self.thickness * confined
    }
}

impl LayerBase {
    fn under(layer: &Material, base: &Base) -> Self {
        match base {
            Base::Frictionless => Self::Frictionless,
            Base::Rigid => Self::Bonded {
                shear_ratio: 0.0,
                poisson_ratio: 0.0,
            },
            Base::Elastic(base) => Self::Bonded {
                shear_ratio: layer.shear_modulus() / base.shear_modulus(),
                poisson_ratio: base.poisson_ratio,
            },
        }
    }
}
