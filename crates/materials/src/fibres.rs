//! Families of fibres, with or without dispersion (theory/inelastic#fibres). A branch of [`crate::Inelastic`], whose state is the direction.

use crate::error::{MaterialError, finite};
use crate::state::Invariants;
use stoss_continuum::{ConstitutiveError, Response, SymmetricTensor2, Tensor4, Want};

const NAME: &str = "fibres";

/// Holzapfel, Gasser and Ogden's fibres: `k1/(2 k2) (exp(k2 <E>^2) - 1)` for each family, with `E = dispersion (J^(-2/3) I1 - 3) + (1 - 3 dispersion) (J^(-2/3) a . C a - 1)`
/// of its direction `a` in the reference configuration; fibres carry tension only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fibres {
    /// `k1`, positive (stress).
    pub stiffness: f64,
    /// `k2`, positive: how fast they stiffen.
    pub exponent: f64,
    /// How far they scatter about their direction: 0 all along it, 1/3 in no direction more than in others.
    pub dispersion: f64,
}

impl Fibres {
    pub(crate) fn check(&self) -> Result<(), MaterialError> {
        let refuse = |parameter, value, range| Err(MaterialError::OutOfRange { law: NAME, parameter, value, range });
        let Self { stiffness, exponent, dispersion } = *self;
        finite(NAME, &[("k1", stiffness), ("k2", exponent), ("dispersion", dispersion)])?;
        if stiffness <= 0.0 {
            return refuse("k1", stiffness, "positive");
        }
        if exponent <= 0.0 {
            return refuse("k2", exponent, "positive");
        }
        if !(0.0..=1.0 / 3.0).contains(&dispersion) {
            return refuse("dispersion", dispersion, "from 0 to 1/3");
        }
        Ok(())
    }

    /// Energy, stress and moduli of a family along the unit vector `a`.
    pub(crate) fn respond(&self, a: [f64; 3], c: &SymmetricTensor2, want: Want) -> Result<Response, ConstitutiveError> {
        let Self { stiffness, exponent, dispersion } = *self;
        let mut out = Response { energy: 0.0, stress: SymmetricTensor2::ZERO, moduli: Tensor4::ZERO };
        let of = Invariants::new(c)?;
        let along = SymmetricTensor2([a[0] * a[0], a[1] * a[1], a[2] * a[2], a[0] * a[1], a[1] * a[2], a[0] * a[2]]);
        let structure = SymmetricTensor2::IDENTITY * dispersion + along * (1.0 - 3.0 * dispersion);
        // `j H : C - 1` of the order of `C - 1` in each term; the trace of the structure tensor `H` is 1.
        let less = (-2.0 / 3.0 * of.log_j).exp_m1();
        let j = 1.0 + less;
        let strain = j * structure.double_contract(&(*c - SymmetricTensor2::IDENTITY)) + less;
        if strain.is_nan() || strain <= 0.0 {
            return Ok(out);
        }
        let square = exponent * strain * strain;
        out.energy = 0.5 * stiffness / exponent * square.exp_m1();
        if want == Want::Energy {
            return Ok(out);
        }
        let inverse = c.inverse_with_det(of.det_c);
        let whole = structure.double_contract(c);
        let s = (structure - inverse * (whole / 3.0)) * (2.0 * j);
        let first = stiffness * strain * square.exp();
        out.stress = s * first;
        if want == Want::Moduli {
            let isochoric = j * whole;
            out.moduli = Tensor4::inverse_derivative(&inverse) * (-4.0 / 3.0 * isochoric * first);
            out.moduli.add_dyad(-4.0 / 9.0 * isochoric * first, &inverse, &inverse);
            out.moduli.add_dyad(-2.0 / 3.0 * first, &s, &inverse);
            out.moduli.add_dyad(-2.0 / 3.0 * first, &inverse, &s);
            out.moduli.add_dyad(stiffness * square.exp() * (1.0 + 2.0 * square), &s, &s);
        }
        Ok(out)
    }
}
