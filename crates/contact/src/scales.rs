//! What contact of a pair of surfaces is weighed against: stiffness, mass and waves of the bodies behind them.

/// Gaps are held, where nothing else is asked for, unless a wave passes through more elements than this in a step: the motion is slow against waves then, and a gap that is held is a part of the depth.
const RESOLVED: f64 = 12.0;

/// The bodies behind two surfaces, the slave's first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairScales {
    /// Young's moduli at small strains; infinite of rigid bodies.
    pub young: [f64; 2],
    /// Length of a facet.
    pub length: f64,
    /// Axial stiffness (a force) of a slave that is a beam or string; pressures are forces per length then.
    pub axial: Option<f64>,
    /// Mass per area of what is behind the surfaces, of a line per length: the larger one; zero in statics.
    pub inertia: f64,
    /// Size of a step, a time.
    pub step: f64,
}

impl PairScales {
    /// Steps without a break after which a gap that was held comes down, where nothing else is asked for.
    pub const SETTLE: u32 = 500;

    /// Factor of gaps in the complementarity function, pressure per length: the softer body decides how its two terms balance; between rigid ones what moves the lighter one by a length in a step. No result depends on it.
    pub fn complementarity(&self) -> f64 {
        let [a, b] = self.young;
        let softer = f64::INFINITY.min(a).min(b);
        match self.axial {
            Some(axial) => softer.min(axial / (self.length * self.length)),
            None if softer.is_finite() => softer / self.length,
            None => self.inertia / self.step.powi(2),
        }
    }

    /// Elements of the size `length` that a wave passes through in a `step` (a time), in a body with this Young's modulus and density.
    pub fn courant(young: f64, density: f64, length: f64, step: f64) -> f64 {
        (young / density).sqrt() * step / length
    }

    /// Whether gaps are held in the step in which they close, where nothing else is asked for; `courant`: of the body where it is least.
    pub fn holds_gaps(courant: f64) -> bool {
        courant <= RESOLVED
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_softer_side_decides_and_between_rigid_ones_the_mass() {
        let soft = PairScales { young: [200.0, 50.0], length: 0.5, axial: None, inertia: 3.0, step: 0.1 };
        assert_eq!(soft.complementarity(), 100.0);
        let line = PairScales { axial: Some(5.0), ..soft };
        assert_eq!(line.complementarity(), 20.0);
        let rigid = PairScales { young: [f64::INFINITY; 2], ..soft };
        assert!((rigid.complementarity() - 300.0).abs() < 1e-12);
        assert!((PairScales::courant(400.0, 4.0, 0.5, 0.1) - 2.0).abs() < 1e-15);
        assert!(PairScales::holds_gaps(12.0) && !PairScales::holds_gaps(f64::INFINITY));
    }
}
