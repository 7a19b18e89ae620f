//! A material with history as a sum: the rest of an elastic law, softened or not, branches that yield or creep, and the energy of the change of volume
//! (theory/inelastic). The branches are in `plasticity` and `maxwell`, the strains in `logarithmic`.

use crate::error::MaterialError;
use crate::fibres::Fibres;
use crate::hencky::Hencky;
use crate::logarithmic::{LogStrain, deviator, function, moved, strain_behind};
use crate::maxwell::Maxwell;
use crate::mullins::Mullins;
use crate::plasticity::{J2, J2State, LogResponse, Plasticity};
use crate::volume::{Logarithmic, Sum};
use std::sync::Arc;
use stoss_continuum::volume::pressure_stress;
use stoss_continuum::{
    ConstitutiveError, HyperelasticLaw, Loss, Material, Mechanisms, PointStep, Response, SmallStrainModuli, StateEntry,
    StateOutput, StepLaw, StepStress, SymmetricTensor2, Tensor4, VolumetricEnergy, VolumetricSplit, Want,
};

/// Whose moduli a law with Maxwell branches was given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Moduli {
    /// Moduli of fast strains: the branches take their shares out of them.
    #[default]
    Instantaneous,
    /// Moduli that are left when all branches have relaxed.
    LongTerm,
}

/// One term of the sum that flows.
#[derive(Clone, Debug)]
enum Branch {
    J2(J2),
    Maxwell(Maxwell),
    /// Elastic; its state is its direction, at first this one.
    Fibres(Fibres, [f64; 3]),
}

impl Branch {
    fn state_len(&self) -> usize {
        match self {
            Self::J2(j2) => 7 + if j2.has_back_strain() { 6 } else { 0 },
            // The map, and the elastic strain in its frame.
            Self::Maxwell(_) => 12,
            Self::Fibres(..) => 3,
        }
    }

    /// Appends the state of a point that has seen nothing.
    fn virgin(&self, out: &mut Vec<f64>) {
        let end = out.len() + self.state_len();
        match self {
            Self::J2(_) | Self::Maxwell(_) => out.extend(SymmetricTensor2::IDENTITY.0),
            Self::Fibres(_, direction) => out.extend(direction),
        }
        out.resize(end, 0.0);
    }

    fn entries(&self, number: usize, out: &mut Vec<StateEntry>) {
        let mut add = |name: String, len, about| out.push(StateEntry { name, len, about });
        match self {
            Self::J2(j2) => {
                add("plastic_map".into(), 6, "Inverse of the plastic stretch, `C_p^(-1/2)`, in reference axes.");
                add("equivalent_plastic_strain".into(), 1, "Equivalent plastic strain, logarithmic, a number.");
                if j2.has_back_strain() {
                    add("back_strain".into(), 6, "Back strain; the back stress is `2/3 H_k` of it.");
                }
            }
            Self::Maxwell(_) => {
                add(format!("viscous_map_{number}"), 6, "Inverse of the viscous stretch, in reference axes.");
                add(format!("viscous_elastic_strain_{number}"), 6, "Elastic strain of the branch, behind its map.");
            }
            Self::Fibres(..) => {
                add(
                    format!("fibre_direction_{number}"),
                    3,
                    "Unit vector along the fibres in the reference configuration.",
                );
            }
        }
    }

    /// Adds the law of the step.
    fn add(
        &self,
        state: &[f64],
        at: &PointStep<'_>,
        c: &SymmetricTensor2,
        want: Want,
        out: &mut Response,
    ) -> Result<(), ConstitutiveError> {
        if let Self::Fibres(fibres, _) = self {
            let of = fibres.respond(std::array::from_fn(|i| state[i]), c, want)?;
            out.energy += of.energy;
            if want >= Want::Stress {
                out.stress += of.stress;
            }
            if want == Want::Moduli {
                out.moduli.add_scaled(1.0, &of.moduli);
            }
            return Ok(());
        }
        let strain = LogStrain::new(Some(&tensor(state)), c)?;
        let response = self.respond(state, at, &strain);
        out.energy += response.energy;
        match want {
            Want::Energy => {}
            Want::Stress => strain.add_stress(&response.stress, &mut out.stress),
            Want::Moduli => {
                strain.add_moduli(&response.stress, &response.moduli, &mut out.stress, &mut out.moduli);
            }
        }
        Ok(())
    }

    /// The law of the step at a strain behind the branch's map.
    fn respond(&self, state: &[f64], at: &PointStep<'_>, strain: &LogStrain) -> LogResponse {
        let e = strain.deviator();
        match self {
            Self::Fibres(..) => unreachable!("fibres have no map"),
            Self::J2(j2) if at.stress == StepStress::Frozen => j2.elastic(&e),
            Self::J2(j2) => {
                let mut of = j2_state(j2, state);
                if j2.has_back_strain() {
                    of.back = strain.turned(&of.back);
                }
                j2.respond(&e, &of, J2::time(at.stress, at.dt))
            }
            Self::Maxwell(maxwell) => {
                let start = strain.turned(&tensor(&state[6..]));
                maxwell.respond(&e, &start, at.stress, at.dt)
            }
        }
    }

    /// The state at the end of a step, over a copy of that at its begin, and what was lost.
    fn commit(
        &self,
        at: &PointStep<'_>,
        state: &[f64],
        [c_n, c_np1]: [&SymmetricTensor2; 2],
        next: &mut [f64],
    ) -> Result<Loss, ConstitutiveError> {
        if let Self::Fibres(..) = self {
            return Ok(Loss::default());
        }
        let map = tensor(state);
        let strain = strain_behind(&map, c_np1)?;
        let e = deviator(&strain);
        match self {
            Self::Fibres(..) => unreachable!("fibres have no map"),
            Self::J2(j2) => {
                let of = j2_state(j2, state);
                let found = j2.solve(&e, &of, at.dt);
                let e_n = match j2.of.overstress {
                    // Only the loss of an overstress needs it.
                    None => e,
                    Some(_) => deviator(&strain_behind(&map, c_n)?),
                };
                let loss = j2.loss(&found, &of, [&e_n, &e], at.stress, at.dt);
                if found.increment == 0.0 {
                    return Ok(loss);
                }
                let flow = found.flow();
                let coaxial = !j2.has_back_strain();
                next[..6].copy_from_slice(&moved(&map, c_np1, &strain, &(strain - flow), coaxial).map.0);
                next[6] = of.alpha + found.increment;
                if j2.has_back_strain() {
                    next[7..13].copy_from_slice(&(of.back + flow).0);
                }
                Ok(loss)
            }
            Self::Maxwell(maxwell) => {
                let (end, viscous) = maxwell.end(&e, &tensor(&state[6..]), at.dt);
                let end = strain - e + end;
                let moved = moved(&map, c_np1, &strain, &end, false);
                next[..6].copy_from_slice(&moved.map.0);
                next[6..12].copy_from_slice(&deviator(&end.rotated(&moved.rotation)).0);
                Ok(Loss { viscous, ..Loss::default() })
            }
        }
    }
}

fn tensor(numbers: &[f64]) -> SymmetricTensor2 {
    SymmetricTensor2(std::array::from_fn(|i| numbers[i]))
}

fn j2_state(j2: &J2, state: &[f64]) -> J2State {
    let back = if j2.has_back_strain() { tensor(&state[7..]) } else { SymmetricTensor2::ZERO };
    J2State { alpha: state[6], back }
}

/// What output shows of these branches.
fn outputs(branches: &[Branch]) -> Vec<StateOutput> {
    let mut out = Vec::new();
    let mut add = |name: &str, len, jumps, about| {
        out.push(StateOutput { entry: StateEntry { name: name.to_owned(), len, about }, jumps });
    };
    for branch in branches {
        if let Branch::J2(j2) = branch {
            add("equivalent_plastic_strain", 1, false, "Equivalent plastic strain, logarithmic, a number.");
            add("plastic_strain", 6, false, "Plastic strain, logarithmic, in reference axes.");
            add("yielding", 1, true, "1 where the point has yielded in the last step, else 0.");
            if j2.has_back_strain() {
                add("back_stress", 6, false, "Back stress of kinematic hardening, in reference axes.");
            }
        }
    }
    if branches.iter().any(|branch| matches!(branch, Branch::Maxwell(_))) {
        let about =
            "Viscous strain of the Maxwell branches, logarithmic, in reference axes, the mean by their shear moduli.";
        add("viscous_strain", 6, false, about);
    }
    out
}

/// The logarithm of an inelastic stretch, of which `map` is the inverse.
fn strain_of(map: &SymmetricTensor2) -> SymmetricTensor2 {
    function(map, |x| -x.ln())
}

/// The rest `W(C)` of an elastic law, scaled.
#[derive(Clone, Debug)]
struct Base {
    law: Arc<dyn HyperelasticLaw>,
    share: f64,
}

impl Base {
    fn respond(&self, c: &SymmetricTensor2, want: Want) -> Result<Response, ConstitutiveError> {
        let (energy, stress, moduli) = match want {
            Want::Energy => (self.law.energy(c)?, SymmetricTensor2::ZERO, Tensor4::ZERO),
            Want::Stress => {
                let (energy, stress) = self.law.energy_and_stress(c)?;
                (energy, stress, Tensor4::ZERO)
            }
            Want::Moduli => {
                let (stress, moduli) = self.law.stress_and_elasticity(c)?;
                (self.law.energy(c)?, stress, moduli)
            }
        };
        Ok(Response { energy: energy * self.share, stress: stress * self.share, moduli: moduli * self.share })
    }
}

/// An elastic law with plasticity, Maxwell branches, softening or fibres, alone or together: the law of a step for each (theory/inelastic).
///
/// As a hyperelastic law it is that of virgin points without flow, with the moduli of fast strains.
#[derive(Clone, Debug)]
pub struct Inelastic {
    name: String,
    base: Option<Base>,
    mullins: Option<Mullins>,
    branches: Vec<Branch>,
    /// `U`; nothing in the part of a mixed body that has the state.
    volume: Option<Arc<dyn VolumetricEnergy>>,
    moduli: SmallStrainModuli,
    entries: Vec<StateEntry>,
    outputs: Vec<StateOutput>,
    virgin: Vec<f64>,
}

impl Inelastic {
    /// A metal: [`Hencky`]'s law that yields.
    ///
    /// # Errors
    /// A yield stress that is not positive, a table that does not begin at zero or does not grow, softening without a solution of the return.
    pub fn plastic(law: Hencky, plasticity: Plasticity) -> Result<Self, MaterialError> {
        let j2 = J2 { mu: law.shear(), of: plasticity };
        j2.of.check(j2.mu)?;
        let moduli = law.small_strain_moduli();
        let volume: Arc<dyn VolumetricEnergy> = Arc::new(Logarithmic { lambda: moduli.bulk });
        Ok(Self::assembled("hencky", None, None, vec![Branch::J2(j2)], Some(volume), moduli))
    }

    /// A law of which the part without the energy of the change of volume has Maxwell branches: `shares` are pairs of a share `g` of the shear modulus of fast
    /// strains, and a relaxation time. The change of volume is elastic with the bulk modulus of the law.
    ///
    /// # Errors
    /// A law without such parts ([`HyperelasticLaw::volumetric`]) or with a history; shares or times that are not positive, shares that sum up to 1 or more.
    pub fn viscous(
        law: &Arc<dyn HyperelasticLaw>,
        shares: &[(f64, f64)],
        moduli: Moduli,
    ) -> Result<Self, MaterialError> {
        let VolumetricSplit { rest, mut volume } = split(law)?;
        let relaxing: f64 = shares.iter().map(|share| share.0).sum();
        if relaxing >= 1.0 || relaxing.is_nan() {
            let range = "shares that sum up to less than 1";
            return Err(MaterialError::OutOfRange { law: "prony", parameter: "prony", value: relaxing, range });
        }
        let given = law.small_strain_moduli();
        let (share, shear) = match moduli {
            Moduli::Instantaneous => (1.0 - relaxing, given.shear),
            Moduli::LongTerm => (1.0, given.shear / (1.0 - relaxing)),
        };
        let mut branches = Vec::with_capacity(shares.len());
        for &(g, time) in shares {
            let branch = Maxwell { shear: g * shear, time };
            branch.check()?;
            branches.push(Branch::Maxwell(branch));
        }
        // What the smaller share of the rest lacks of the bulk modulus.
        let lacking = (1.0 - share) * rest.small_strain_moduli().bulk;
        if lacking != 0.0 {
            volume = Arc::new(Sum { one: volume, more: Logarithmic { lambda: lacking } });
        }
        let all = SmallStrainModuli { shear, bulk: given.bulk };
        Ok(Self::assembled(law.name(), Some(Base { law: rest, share }), None, branches, Some(volume), all))
    }

    /// A law of which the part without the energy of the change of volume softens.
    ///
    /// # Errors
    /// A law without such parts or with a history; parameters out of range.
    pub fn softening(law: &Arc<dyn HyperelasticLaw>, mullins: Mullins) -> Result<Self, MaterialError> {
        let VolumetricSplit { rest, volume } = split(law)?;
        mullins.check()?;
        let base = Base { law: rest, share: 1.0 };
        Ok(Self::assembled(law.name(), Some(base), Some(mullins), Vec::new(), Some(volume), law.small_strain_moduli()))
    }

    /// The material with softening of its elastic part.
    ///
    /// # Errors
    /// Parameters out of range; a material whose only part yields.
    pub fn with_softening(self, mullins: Mullins) -> Result<Self, MaterialError> {
        mullins.check()?;
        if self.base.is_none() {
            return Err(MaterialError::NoSplit { law: "a law that yields", part: "mullins" });
        }
        Ok(Self::assembled(&self.name, self.base, Some(mullins), self.branches, self.volume, self.moduli))
    }

    /// The part of a law without the energy of the change of volume, and that energy, with nothing more.
    fn plain(law: &Arc<dyn HyperelasticLaw>) -> Result<Self, MaterialError> {
        let VolumetricSplit { rest, volume } = split(law)?;
        let base = Base { law: rest, share: 1.0 };
        Ok(Self::assembled(law.name(), Some(base), None, Vec::new(), Some(volume), law.small_strain_moduli()))
    }

    /// A law with families of fibres, each along a direction of any length but zero. The directions are those of virgin points; states of points may have others, which stay.
    ///
    /// # Errors
    /// A law without such parts or with a history; parameters out of range, directions that are none.
    pub fn fibrous(
        law: &Arc<dyn HyperelasticLaw>,
        fibres: Fibres,
        directions: &[[f64; 3]],
    ) -> Result<Self, MaterialError> {
        Self::plain(law)?.with_fibres(fibres, directions)
    }

    /// The material with families of fibres beside what it has: they neither relax nor soften.
    ///
    /// # Errors
    /// Parameters out of range, directions that are none; a material that yields.
    pub fn with_fibres(self, fibres: Fibres, directions: &[[f64; 3]]) -> Result<Self, MaterialError> {
        fibres.check()?;
        if self.base.is_none() {
            return Err(MaterialError::NoSplit { law: "a law that yields", part: "fibres" });
        }
        let Self { name, base, mullins, mut branches, volume, moduli, .. } = self;
        for a in directions {
            let length = a.iter().map(|x| x * x).sum::<f64>().sqrt();
            if !(length > 0.0 && length.is_finite()) {
                let range = "the length of a vector that is not zero";
                return Err(MaterialError::OutOfRange { law: "fibres", parameter: "direction", value: length, range });
            }
            branches.push(Branch::Fibres(fibres, a.map(|x| x / length)));
        }
        Ok(Self::assembled(&name, base, mullins, branches, volume, moduli))
    }

    fn assembled(
        name: &str,
        base: Option<Base>,
        mullins: Option<Mullins>,
        branches: Vec<Branch>,
        volume: Option<Arc<dyn VolumetricEnergy>>,
        moduli: SmallStrainModuli,
    ) -> Self {
        let mut entries = Vec::new();
        if mullins.is_some() {
            let about = "Largest energy per volume of the softening part so far.";
            entries.push(StateEntry { name: "largest_energy".into(), len: 1, about });
        }
        let mut virgin = vec![0.0; usize::from(mullins.is_some())];
        let (mut flowing, mut fibres) = (0, 0);
        for branch in &branches {
            let number = if matches!(branch, Branch::Fibres(..)) { &mut fibres } else { &mut flowing };
            *number += 1;
            branch.entries(*number, &mut entries);
            branch.virgin(&mut virgin);
        }
        let outputs = outputs(&branches);
        Self { name: name.to_string(), base, mullins, branches, volume, moduli, entries, outputs, virgin }
    }

    fn virgin_law(&self) -> StepLaw<'_> {
        StepLaw { material: self, at: PointStep { state: &self.virgin, dt: 0.0, stress: StepStress::Frozen } }
    }

    /// The states of the branches, behind what softening has.
    fn states<'a>(&'a self, state: &'a [f64]) -> impl Iterator<Item = (&'a Branch, usize)> + use<'a> {
        let mut place = usize::from(self.mullins.is_some());
        debug_assert_eq!(state.len(), self.virgin.len());
        self.branches.iter().map(move |branch| {
            let at = place;
            place += branch.state_len();
            (branch, at)
        })
    }
}

/// The parts of a law that is to get a history.
fn split(law: &Arc<dyn HyperelasticLaw>) -> Result<VolumetricSplit, MaterialError> {
    let refused = || MaterialError::NoSplit { law: "this law", part: "prony, mullins or fibres" };
    if law.history().is_some() {
        return Err(refused());
    }
    law.volumetric().ok_or_else(refused)
}

impl Material for Inelastic {
    fn state(&self) -> &[StateEntry] {
        &self.entries
    }

    fn state_len(&self) -> usize {
        self.virgin.len()
    }

    fn virgin(&self, state: &mut [f64]) {
        state.copy_from_slice(&self.virgin);
    }

    fn respond(&self, at: &PointStep<'_>, c: &SymmetricTensor2, want: Want) -> Result<Response, ConstitutiveError> {
        let mut out = match &self.base {
            Some(base) => base.respond(c, want)?,
            None => Response { energy: 0.0, stress: SymmetricTensor2::ZERO, moduli: Tensor4::ZERO },
        };
        if let Some(mullins) = &self.mullins {
            let softened = mullins.at(out.energy, at.state[0]);
            out.energy = softened.energy;
            if want == Want::Moduli {
                out.moduli = out.moduli * softened.factor;
                let stress = out.stress;
                out.moduli.add_dyad(softened.slope, &stress, &stress);
            }
            out.stress = out.stress * softened.factor;
        }
        for (branch, first) in self.states(at.state) {
            branch.add(&at.state[first..], at, c, want, &mut out)?;
        }
        if at.stress == StepStress::Frozen {
            out.energy += self.hardening_energy(at.state);
        }
        if let Some(volume) = &self.volume {
            let det_c = c.det();
            if det_c <= 0.0 || det_c.is_nan() {
                return Err(ConstitutiveError::NonPositiveJacobian { det_c });
            }
            let j = det_c.sqrt();
            out.energy += volume.energy(j);
            if want >= Want::Stress {
                let (p, slope) = volume.pressure(j);
                let (stress, moduli) = pressure_stress(p, c, j);
                out.stress += stress;
                if want == Want::Moduli {
                    out.moduli.add_scaled(1.0, &moduli);
                    let inverse = c.inverse_with_det(det_c);
                    out.moduli.add_dyad(slope * det_c, &inverse, &inverse);
                }
            }
        }
        let finite = out.energy.is_finite()
            && (want < Want::Stress || out.stress.is_finite())
            && (want < Want::Moduli || out.moduli.is_finite());
        if finite { Ok(out) } else { Err(ConstitutiveError::NonFinite) }
    }

    fn commit(
        &self,
        at: &PointStep<'_>,
        c_n: &SymmetricTensor2,
        c_np1: &SymmetricTensor2,
        next: &mut [f64],
    ) -> Result<Loss, ConstitutiveError> {
        next.copy_from_slice(at.state);
        let mut loss = Loss::default();
        if let (Some(mullins), Some(base)) = (&self.mullins, &self.base) {
            let w = base.respond(c_np1, Want::Energy)?.energy;
            if w > at.state[0] {
                // What the step took, less what unloading will give back.
                loss.softening = mullins.at(w, at.state[0]).energy - mullins.at(w, w).energy;
                next[0] = w;
            }
        }
        for (branch, first) in self.states(at.state) {
            loss.add(1.0, &branch.commit(at, &at.state[first..], [c_n, c_np1], &mut next[first..])?);
        }
        if loss.total().is_finite() && next.iter().all(|x| x.is_finite()) {
            Ok(loss)
        } else {
            Err(ConstitutiveError::NonFinite)
        }
    }

    fn mechanisms(&self) -> Mechanisms {
        Mechanisms {
            plastic: self.branches.iter().any(|branch| matches!(branch, Branch::J2(_))),
            viscous: self.branches.iter().any(|branch| matches!(branch, Branch::Maxwell(_))),
            softening: self.mullins.is_some(),
        }
    }

    fn outputs(&self) -> &[StateOutput] {
        &self.outputs
    }

    fn output(&self, before: &[f64], state: &[f64], out: &mut [f64]) {
        let mut rest = out;
        let mut put = |numbers: &[f64]| {
            let (own, others) = std::mem::take(&mut rest).split_at_mut(numbers.len());
            own.copy_from_slice(numbers);
            rest = others;
        };
        let (mut viscous, mut shear) = (SymmetricTensor2::ZERO, 0.0);
        for (branch, first) in self.states(state) {
            let map = || tensor(&state[first..]);
            match branch {
                Branch::Fibres(..) => {}
                Branch::J2(j2) => {
                    put(&[state[first + 6]]);
                    put(&strain_of(&map()).0);
                    put(&[f64::from(u8::from(state[first + 6] > before[first + 6]))]);
                    if j2.has_back_strain() {
                        put(&j2.back_stress(&tensor(&state[first + 7..])).0);
                    }
                }
                Branch::Maxwell(maxwell) => {
                    viscous += strain_of(&map()) * maxwell.shear;
                    shear += maxwell.shear;
                }
            }
        }
        if shear > 0.0 {
            put(&(viscous * (1.0 / shear)).0);
        }
    }

    fn flow(&self, before: &[f64], next: &[f64]) -> f64 {
        let yielding = self.states(next).filter(|(branch, _)| matches!(branch, Branch::J2(_)));
        yielding.map(|(_, first)| next[first + 6] - before[first + 6]).fold(0.0, f64::max)
    }

    fn hardening_energy(&self, state: &[f64]) -> f64 {
        let of = |(branch, first): (&Branch, usize)| match branch {
            Branch::J2(j2) => j2.hardening_energy(&j2_state(j2, &state[first..])),
            Branch::Maxwell(_) | Branch::Fibres(..) => 0.0,
        };
        self.states(state).map(of).sum()
    }
}

impl HyperelasticLaw for Inelastic {
    fn name(&self) -> &str {
        &self.name
    }
    fn energy(&self, c: &SymmetricTensor2) -> Result<f64, ConstitutiveError> {
        self.virgin_law().energy(c)
    }
    fn stress(&self, c: &SymmetricTensor2) -> Result<SymmetricTensor2, ConstitutiveError> {
        self.virgin_law().stress(c)
    }
    fn energy_and_stress(&self, c: &SymmetricTensor2) -> Result<(f64, SymmetricTensor2), ConstitutiveError> {
        self.virgin_law().energy_and_stress(c)
    }
    fn stress_and_elasticity(&self, c: &SymmetricTensor2) -> Result<(SymmetricTensor2, Tensor4), ConstitutiveError> {
        self.virgin_law().stress_and_elasticity(c)
    }
    fn small_strain_moduli(&self) -> SmallStrainModuli {
        self.moduli
    }
    fn volumetric(&self) -> Option<VolumetricSplit> {
        let volume = self.volume.clone()?;
        // What the rest has of the bulk modulus: nothing of branches.
        let bulk = self.base.as_ref().map_or(0.0, |base| base.share * base.law.small_strain_moduli().bulk);
        let rest = Self { volume: None, moduli: SmallStrainModuli { bulk, ..self.moduli }, ..self.clone() };
        Some(VolumetricSplit { rest: Arc::new(rest), volume })
    }
    fn history(&self) -> Option<&dyn Material> {
        Some(self)
    }
    fn smallest_strain_increment(&self) -> f64 {
        stoss_continuum::SMALLEST_STRAIN_INCREMENT_WITH_STATE
    }
}
