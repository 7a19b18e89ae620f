//! What it means for a scene that a keyword of a deck, or a parameter of one, is not read: one table for all of them.
//!
//! A keyword that is not in it counts as missing: nothing is known of it, and it may be a load or a constraint.

use crate::severity::Severity;

/// When the severity of a keyword is not always the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Weight {
    /// The severity is always this one.
    Always(Severity),
    /// The severity of temperatures: a load is missing where a material expands, else nothing mechanical is.
    Thermal,
}

/// What it means that something is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Meaning {
    pub severity: Severity,
    /// What that changes.
    pub consequence: &'static str,
    /// What to do; empty if there is nothing to do.
    pub remedy: &'static str,
}

/// Keywords in upper case without spaces, their weight, what it changes that they are left out, and what to do.
type Row = (&'static [&'static str], Weight, &'static str, &'static str);

const MISSING: Weight = Weight::Always(Severity::Missing);
const CHANGED: Weight = Weight::Always(Severity::Changed);
const NOTE: Weight = Weight::Always(Severity::Note);

const TABLE: &[Row] = &[
    // Constraints and connections.
    (
        &["EQUATION", "EQUATIONF", "MPC", "NETWORKMPC"],
        MISSING,
        "its equations are left out: the nodes are not coupled",
        "see [[equation]], [[tie]] and [[joint]]",
    ),
    (
        &["COUPLING", "KINEMATICCOUPLING", "DISTRIBUTINGCOUPLING", "RIGIDBODY"],
        MISSING,
        "its nodes are not coupled to the reference node, and loads and supports of the reference node are left out",
        "see [[coupling]], [[joint]] and `moment` of [[load]]",
    ),
    (&["KINEMATIC", "DISTRIBUTING"], NOTE, "it belongs to the coupling before it", ""),
    (
        &[
            "EMBEDDEDELEMENT",
            "SHELLTOSOLIDCOUPLING",
            "FASTENER",
            "FASTENERPROPERTY",
            "BOND",
            "RELEASE",
            "PERIODICMEDIA",
        ],
        MISSING,
        "the parts are not joined by it",
        "see [[tie]] and [[joint]]",
    ),
    (
        &[
            "CONNECTORSECTION",
            "CONNECTORBEHAVIOR",
            "CONNECTORELASTICITY",
            "CONNECTORDAMPING",
            "CONNECTORFRICTION",
            "CONNECTORLOAD",
            "CONNECTORMOTION",
            "CONNECTORLOCK",
            "CONNECTORSTOP",
        ],
        MISSING,
        "the connector is not in the scene",
        "see [[joint]] and [[spring]]",
    ),
    (
        &["CYCLICSYMMETRYMODEL"],
        MISSING,
        "the cut surfaces are free",
        "mesh the whole part, or prescribe planes of symmetry",
    ),
    (
        &["TRANSFORM", "TRANSFORMF"],
        MISSING,
        "only rectangular and cylindrical axes of node sets are read: supports and forces in these axes are left out, except where all three components of a node are fixed",
        "write them into the scene, with `normal` of [[prescribe]]",
    ),
    (&["SUBMODEL"], MISSING, "displacements of the other model are not read", "prescribe them by [[prescribe]]"),
    (
        &["BOUNDARY", "BOUNDARYF", "BASEMOTION", "INERTIARELIEF"],
        MISSING,
        "these motions are not prescribed: the nodes are free",
        "write [[prescribe]] for them",
    ),
    (&["TIE"], MISSING, "the surfaces are not joined", "write a [[tie]]"),
    // Loads.
    (
        &["PRE-TENSIONSECTION", "PRETENSIONSECTION"],
        MISSING,
        "the bolt has no pretension: it is not cut, and loads of its node are left out",
        "cut the bolt, and use a [[joint]] of kind `slider` with `pretension`",
    ),
    (
        &["CLOAD", "DLOAD", "DSLOAD", "DSLOADF", "INCIDENTWAVE", "INITIALSTRAININCREASE"],
        MISSING,
        "this load does not act",
        "see [[load]] for the kinds of loads of Stoss",
    ),
    (
        &["CONTACTINTERFERENCE"],
        MISSING,
        "the interference is not imposed: overlaps and gaps are those of the mesh",
        "build the overlap into the mesh: contact closes it in the first step",
    ),
    (
        &[
            "TEMPERATURE",
            "CFLUX",
            "DFLUX",
            "DSFLUX",
            "FILM",
            "SFILM",
            "RADIATE",
            "SRADIATE",
            "HEATTRANSFER",
            "FIELD",
            "MASSFLOW",
            "VIEWFACTOR",
        ],
        Weight::Thermal,
        "temperatures and thermal strains are not computed",
        "no change is needed if they do not matter for the mechanical results",
    ),
    (
        &[
            "EXPANSION",
            "CONDUCTIVITY",
            "SPECIFICHEAT",
            "SPECIFICGASCONSTANT",
            "GAPCONDUCTANCE",
            "GAPHEATGENERATION",
            "PHYSICALCONSTANTS",
            "LATENTHEAT",
            "FLUIDCONSTANTS",
            "ELECTRICALCONDUCTIVITY",
            "MAGNETICPERMEABILITY",
            "DIFFUSIVITY",
            "VALUESATINFINITY",
        ],
        NOTE,
        "temperatures and thermal strains are not computed",
        "no change is needed if they do not matter for the mechanical results",
    ),
    (
        &["INITIALCONDITIONS"],
        MISSING,
        "these initial conditions are left out: bodies begin without stress",
        "check that the results do not depend on them",
    ),
    (
        &["AMPLITUDE"],
        NOTE,
        "loads and displacements with this amplitude are left out",
        "define it by a table of times and values",
    ),
    // Contact, and what changes from step to step.
    (
        &["CONTACT", "CONTACTINCLUSIONS", "CONTACTEXCLUSIONS"],
        MISSING,
        "general contact of the deck is not in the scene",
        "see [general_contact]",
    ),
    (
        &["CONTACTPROPERTYASSIGNMENT", "SURFACEPROPERTYASSIGNMENT", "COHESIVEBEHAVIOR", "COHESIVESECTION"],
        MISSING,
        "properties of contact that it gives are not used",
        "see `friction` and `enforcement` of [[contact]], and [general_contact]",
    ),
    (
        &["CONTACTINITIALIZATIONDATA", "CONTACTINITIALIZATIONASSIGNMENT", "CLEARANCE"],
        MISSING,
        "gaps and overlaps at the start are those of the mesh",
        "move the nodes of the mesh",
    ),
    (
        &["MODELCHANGE"],
        MISSING,
        "nothing is added or removed between steps",
        "for contacts and loads see `off` of [[stage]]",
    ),
    (
        &[
            "CHANGEFRICTION",
            "CHANGESURFACEBEHAVIOR",
            "CHANGECONTACTTYPE",
            "CHANGEMATERIAL",
            "CHANGEPLASTIC",
            "CHANGESOLIDSECTION",
        ],
        MISSING,
        "it changes nothing: properties stay as they are at the start",
        "for contacts with other properties in a later step see `off` of [[stage]]",
    ),
    (&["CONTACTDAMPING"], CHANGED, "contact has no damping", ""),
    (
        &["CONTACTCONTROLS", "CONTACTFORMULATION", "CONTACTSTABILIZATION"],
        NOTE,
        "Stoss has rules of its own for the solution of contact",
        "see `stabilise` of [time] if a body is held by contact alone",
    ),
    // Parts that no element of the scene stands for.
    (
        &["SPRING", "DASHPOT", "GAP", "GAPUNIT", "MASS", "ROTARYINERTIA", "NONSTRUCTURALMASS", "FOUNDATION"],
        MISSING,
        "it is not in the scene",
        "see [[spring]], [[support]] and [[mass]]",
    ),
    (
        &[
            "SHELLSECTION",
            "SHELLGENERALSECTION",
            "BEAMSECTION",
            "BEAMGENERALSECTION",
            "MEMBRANESECTION",
            "MEMBRANE",
            "SURFACESECTION",
            "GASKETSECTION",
            "USERSECTION",
            "USERELEMENT",
            "UELPROPERTY",
            "MATRIXINPUT",
            "MATRIXASSEMBLE",
            "SUBSTRUCTUREPROPERTY",
            "RIGIDSURFACE",
            "SUPERELEMENT",
        ],
        MISSING,
        "its elements are not in the scene",
        "for beams see [[beam]], for rigid surfaces [[rigid]]",
    ),
    (
        &["FLUIDSECTION", "NODALTHICKNESS", "NORMAL", "CONSTRAINEDPOINTS"],
        NOTE,
        "it belongs to elements that Stoss does not have",
        "",
    ),
    // Laws.
    (
        &["PLASTIC"],
        CHANGED,
        "of *PLASTIC only isotropic hardening and kinematic hardening of two points are imported, both without rates: the body has the elastic part only, and stresses above the yield stress are wrong",
        "give the material `law = \"hencky\"` and a `plasticity` (see `kinematic_modulus` and `rate` there)",
    ),
    (
        &[
            "DEFORMATIONPLASTICITY",
            "DRUCKERPRAGER",
            "DRUCKERPRAGERHARDENING",
            "MOHRCOULOMB",
            "MOHRCOULOMBHARDENING",
            "CASTIRONPLASTICITY",
            "POTENTIAL",
            "CONCRETE",
            "CRUSHABLEFOAM",
        ],
        CHANGED,
        "there is no plasticity of this kind: the body has the elastic part only, and stresses above the yield stress are wrong",
        "use the scene only where the deck stays elastic, or give the material `law = \"hencky\"` and a `plasticity`",
    ),
    (
        &["RATEDEPENDENT"],
        CHANGED,
        "it is left out: the yield stress is that of *PLASTIC at every rate, and a body without *PLASTIC does not yield",
        "give the `plasticity` of the material a `rate`, an overstress",
    ),
    (
        &["CYCLICHARDENING"],
        CHANGED,
        "it is left out: the yield stress is that of *PLASTIC in every cycle, and a body without an imported *PLASTIC does not yield",
        "give the `plasticity` of the material a `hardening` of its own",
    ),
    (
        &["CREEP"],
        CHANGED,
        "there is no creep: under lasting loads strains are too small, and stresses do not relax",
        "use the scene only for short times, or give a `plasticity` a `rate`",
    ),
    (
        &["VISCOELASTIC"],
        CHANGED,
        "only TIME=PRONY is imported: the material does not relax",
        "give the material `prony`, pairs of a share of the shear modulus and a relaxation time; saint-venant-kirchhoff cannot have it, take neo-hooke",
    ),
    (
        &["SWELLING"],
        CHANGED,
        "there is no swelling: its strains are missing",
        "use the scene only where it does not act",
    ),
    (
        &["MULLINSEFFECT"],
        CHANGED,
        "only the numbers r, m and beta without temperatures or test data are imported: the material does not soften",
        "give the material `mullins` with r, m and beta",
    ),
    (
        &["DAMAGEINITIATION", "DAMAGEEVOLUTION", "DAMAGESTABILIZATION", "FAILSTRESS", "FAILSTRAIN"],
        CHANGED,
        "there is no damage and no failure: the material stays intact",
        "use the scene only where it does",
    ),
    (&["ELASTIC"], CHANGED, "only isotropic elasticity is imported", "give isotropic constants"),
    (
        &["HYPERELASTIC", "HYPERFOAM", "ANISOTROPICHYPERELASTIC", "LOWDENSITYFOAM", "NOCOMPRESSION", "NOTENSION"],
        CHANGED,
        "this law is not imported",
        "fit an Ogden law to the same tests",
    ),
    (
        &["USERMATERIAL", "DEPVAR", "USERDEFINEDFIELD"],
        CHANGED,
        "the law of the material is not known to Stoss",
        "see docs/how-to-add/material-law.md",
    ),
    (
        &["DAMPING", "GLOBALDAMPING"],
        CHANGED,
        "it damps nothing: only *DAMPING, ALPHA=, BETA= of a material is imported",
        "give the body `damping = { mass = ALPHA, stiffness = BETA }`",
    ),
    (
        &["ORIENTATION", "DISTRIBUTION", "DISTRIBUTIONTABLE"],
        NOTE,
        "its directions are not used: materials are isotropic",
        "",
    ),
    // Steps.
    (
        &[
            "COUPLEDTEMPERATURE-DISPLACEMENT",
            "UNCOUPLEDTEMPERATURE-DISPLACEMENT",
            "DYNAMICTEMPERATURE-DISPLACEMENT",
            "COUPLEDTHERMAL-ELECTRICAL",
        ],
        MISSING,
        "the step is left out: temperatures are not computed",
        "make it *STATIC or *DYNAMIC for its mechanical part",
    ),
    (
        &["VISCO", "GEOSTATIC", "SOILS", "STEADYSTATETRANSPORT", "CRACKPROPAGATION"],
        MISSING,
        "the step is left out: Stoss computes *STATIC and *DYNAMIC steps only",
        "make it *STATIC or *DYNAMIC for its mechanical part",
    ),
    (
        &["CFD", "ELECTROMAGNETICS", "SENSITIVITY", "NOANALYSIS", "MASSDIFFUSION", "ROBUSTDESIGN", "FEASIBLEDIRECTION"],
        NOTE,
        "the step is left out: Stoss computes *STATIC and *DYNAMIC steps only",
        "",
    ),
    (
        &[
            "FREQUENCY",
            "COMPLEXFREQUENCY",
            "BUCKLE",
            "MODALDYNAMIC",
            "STEADYSTATEDYNAMICS",
            "RANDOMRESPONSE",
            "RESPONSESPECTRUM",
            "SUBSTRUCTUREGENERATE",
            "GREEN",
        ],
        NOTE,
        "the step is left out: Stoss computes no modes and no linear perturbations",
        "make it *STATIC or *DYNAMIC for a computation over time",
    ),
    (
        &["MODALDAMPING", "SELECTCYCLICSYMMETRYMODES", "SELECTEIGENMODES", "RETAINEDNODALDOFS", "HCF"],
        NOTE,
        "Stoss computes no modes",
        "",
    ),
    (
        &[
            "DESIGNRESPONSE",
            "DESIGNVARIABLES",
            "OBJECTIVE",
            "CONSTRAINT",
            "GEOMETRICCONSTRAINT",
            "GEOMETRICTOLERANCES",
            "FILTER",
            "CORRELATIONLENGTH",
            "RANDOMFIELD",
            "CONTOURINTEGRAL",
            "SUBSTRUCTUREMATRIXOUTPUT",
        ],
        NOTE,
        "it belongs to another analysis than that of motion and stress",
        "",
    ),
    (&["REFINEMESH", "ADAPTIVEMESH", "IMPERFECTION"], CHANGED, "the mesh stays as it is", ""),
    // Settings of the solution.
    (
        &["CONTROLS", "SECTIONCONTROLS", "SOLUTIONTECHNIQUE", "SOLVERCONTROLS"],
        NOTE,
        "Stoss has step control and tolerances of its own",
        "see [solver] and `automatic` of [time]",
    ),
    (
        &["BULKVISCOSITY", "HOURGLASSSTIFFNESS", "FIXEDMASSSCALING", "VARIABLEMASSSCALING", "TRANSVERSESHEARSTIFFNESS"],
        NOTE,
        "the elements and schemes of Stoss have no such setting",
        "",
    ),
];

/// Parameters that mean more, or less, than that their keyword is read without them: keywords, parameters, weight, consequence, remedy.
type ParameterRow = (&'static [&'static str], &'static [&'static str], Weight, &'static str, &'static str);

const PARAMETERS: &[ParameterRow] = &[
    (&["SOLIDSECTION"], &["ORIENTATION"], NOTE, "directions of the section are not used: materials are isotropic", ""),
    (
        &["SOLIDSECTION"],
        &["COMPOSITE"],
        CHANGED,
        "layers of the section are not used: the body has one material",
        "make each layer a body",
    ),
    (&["SOLIDSECTION"], &["CONTROLS", "NODALTHICKNESS"], NOTE, "Stoss has no such option for a section", ""),
    (&["STEP"], &["INC", "INCF"], NOTE, "the number of increments has no limit", ""),
    (
        &["STEP"],
        &["NAME"],
        NOTE,
        "the stage has another name, because that of the step has signs that a name cannot have",
        "",
    ),
    (&["STATIC", "DYNAMIC"], &["TIMERESET", "TOTALTIMEATSTART"], NOTE, "time begins at zero and is not set back", ""),
    (
        &["STATIC"],
        &["RIKS", "STABILIZE"],
        CHANGED,
        "the load is prescribed over time: a snap is not followed backwards",
        "see `stabilise` of [time]",
    ),
    (
        &["CONTACTPAIR"],
        &["TIED"],
        MISSING,
        "the surfaces touch and can open and slide: they are not joined",
        "write a [[tie]] in place of the [[contact]]",
    ),
    (
        &["CONTACTPAIR"],
        &["TYPE"],
        NOTE,
        "the contact is `mortar`, which has pressures for a whole surface",
        "for another method see `method` of [[contact]]",
    ),
    (
        &["CONTACTPAIR"],
        &["CPSET", "EXTENSIONZONE", "HCRIT", "SMOOTH", "NOTHICKNESS", "SUPPLEMENTARYCONSTRAINTS", "TRACKING"],
        NOTE,
        "Stoss has no such option for a contact",
        "",
    ),
    (
        &["FRICTION", "SURFACEBEHAVIOR"],
        &["LAGRANGE", "SLIPTOLERANCE", "DIRECT", "PENALTY", "AUGMENTEDLAGRANGE"],
        NOTE,
        "conditions of contact hold exactly",
        "for a stiffness see `enforcement` of [[contact]]",
    ),
    (&["SURFACEBEHAVIOR"], &["NOSEPARATION"], MISSING, "surfaces that touch may open again", "see [[tie]]"),
    (&["MATERIAL"], &["RTOL", "SRATEFACTOR"], NOTE, "materials of Stoss have no such option", ""),
    (
        &["DENSITY", "ELASTIC", "HYPERELASTIC"],
        &["DEPENDENCIES"],
        NOTE,
        "the values of its first line are used",
        "put the line of your values first",
    ),
];

/// A keyword of a text such as "*AMPLITUDE, DEFINITION=USER" or "parameter OP of *CLOAD", in upper case without spaces.
fn keyword_of(text: &str) -> String {
    let name = text.split_once('*').map_or(text, |(_, keyword)| keyword);
    let name = ["with the parameter", "outside of a step", "but the first"]
        .iter()
        .fold(name, |name, words| name.split(words).next().unwrap_or(name));
    name.chars().take_while(|c| *c != ',').filter(|c| !c.is_whitespace()).collect::<String>().to_uppercase()
}

/// What it means that something of a deck is left out, as its reader names it. `expands`: whether a material of the deck has thermal strains.
pub(crate) fn meaning(what: &str, expands: bool) -> Meaning {
    let keyword = keyword_of(what);
    let of = |weight: Weight, consequence, remedy| {
        let severity = match weight {
            Weight::Always(severity) => severity,
            Weight::Thermal if expands => Severity::Missing,
            Weight::Thermal => Severity::Note,
        };
        Meaning { severity, consequence, remedy }
    };
    if what.starts_with("all lines of") {
        let consequence = "the values of its first line are used at all temperatures";
        return of(CHANGED, consequence, "put the line of your temperature first");
    }
    if let Some((parameter, _)) = what.strip_prefix("parameter ").and_then(|rest| rest.split_once(" of ")) {
        let parameter: String = parameter.chars().filter(|c| !c.is_whitespace()).collect();
        let row = PARAMETERS.iter().find(|(keywords, parameters, ..)| {
            keywords.contains(&keyword.as_str()) && parameters.contains(&parameter.as_str())
        });
        return match row {
            Some((_, _, weight, consequence, remedy)) => of(*weight, consequence, remedy),
            None if keyword == "STEP" => of(NOTE, "it is ignored: Stoss has no such option for a step", ""),
            None => of(
                CHANGED,
                "it is ignored: the keyword is read as if it were not there",
                "check that the results do not depend on it",
            ),
        };
    }
    if let Some(rest) = what.strip_prefix("degree of freedom ") {
        let number = rest.split_whitespace().next().and_then(|number| number.parse::<u64>().ok());
        return match number {
            // A moment is a load; a support of a rotation holds nothing at nodes that do not rotate.
            Some(4..=6) if keyword == "CLOAD" => {
                of(MISSING, "the moment does not act: nodes of solids have no rotations", "see `moment` of [[load]]")
            }
            Some(4..=6) => of(
                NOTE,
                "it is ignored: nodes of solids have the components x, y and z only",
                "for rotations see [[joint]] and `rotation` of [[prescribe]]",
            ),
            _ => of(Weight::Thermal, "it is no displacement: temperatures are not computed", ""),
        };
    }
    if what.starts_with("load ") {
        return of(MISSING, "this load does not act", "see [[load]] for the kinds of loads of Stoss");
    }
    if keyword == "INITIALCONDITIONS" && what.to_uppercase().contains("TYPE=TEMPERATURE") {
        return of(Weight::Thermal, "temperatures and thermal strains are not computed", "");
    }
    if matches!(keyword.as_str(), "STATIC" | "DYNAMIC") {
        return of(MISSING, "a step without *STEP is not computed", "write *STEP before it");
    }
    match TABLE.iter().find(|(keywords, ..)| keywords.contains(&keyword.as_str())) {
        Some((_, weight, consequence, remedy)) => of(*weight, consequence, remedy),
        None => of(
            MISSING,
            "it is left out: Stoss does not know it",
            "check that the results do not depend on it, then remove this entry",
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_keywords_change() {
        // A step that is left out is called so, whatever it computes.
        for procedure in [
            "*VISCO",
            "*BUCKLE",
            "*MASS DIFFUSION, TYPE=A",
            "*DYNAMIC TEMPERATURE-DISPLACEMENT",
            "*STEADY STATE DYNAMICS",
        ] {
            assert!(meaning(procedure, false).consequence.starts_with("the step is left out"), "{procedure}");
        }
        assert!(meaning("all lines of *ELASTIC but the first", false).consequence.contains("first line"));
        assert!(meaning("parameter ORIENTATION of *SOLID SECTION", false).consequence.contains("isotropic"));
        assert!(meaning("*AMPLITUDE, DEFINITION=SMOOTH STEP", false).consequence.contains("with this amplitude"));
        assert!(meaning("*UNHEARD OF", false).consequence.contains("does not know it"));
    }

    /// Severities, in the words of the reader of decks.
    #[test]
    fn severities() {
        use Severity::{Changed, Missing, Note};
        for (what, severity) in [
            ("*EQUATION", Missing),
            ("*MPC", Missing),
            ("*COUPLING", Missing),
            ("*RIGID BODY", Missing),
            ("*PRE-TENSION SECTION", Missing),
            ("*SPRING", Missing),
            ("*MODEL CHANGE", Missing),
            ("*CONTACT INTERFERENCE", Missing),
            ("*CLEARANCE", Missing),
            ("*CHANGE FRICTION", Missing),
            ("*CHANGE SURFACE BEHAVIOR", Missing),
            ("*CYCLIC SYMMETRY MODEL", Missing),
            ("*INITIAL CONDITIONS, TYPE=STRESS", Missing),
            ("*INITIAL STRAIN INCREASE", Missing),
            ("*CLOAD with the parameter TIMEDELAY", Missing),
            ("*BOUNDARY with the parameter SUBMODEL", Missing),
            ("*TIE with the parameter CYCLICSYMMETRY", Missing),
            ("*DLOAD outside of a step", Missing),
            ("load NEWTON of *DLOAD", Missing),
            ("degree of freedom 5 of *CLOAD", Missing),
            ("degree of freedom 5 of *BOUNDARY", Note),
            ("degree of freedom 11 of *BOUNDARY", Note),
            ("parameter TIED of *CONTACT PAIR", Missing),
            ("parameter TYPE of *CONTACT PAIR", Note),
            ("parameter INC of *STEP", Note),
            ("parameter UNSYMM of *STEP", Note),
            ("parameter TAUMAX of *FRICTION", Changed),
            ("*PLASTIC", Changed),
            ("*CREEP", Changed),
            ("*CONTROLS", Note),
            ("*FREQUENCY", Note),
            ("*SOMETHING ELSE", Missing),
        ] {
            assert_eq!(meaning(what, false).severity, severity, "{what}");
        }
        // A temperature is a load where something expands.
        for what in [
            "*TEMPERATURE",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE",
            "degree of freedom 11 of *CFLUX",
            "*HEAT TRANSFER",
        ] {
            assert_eq!([false, true].map(|expands| meaning(what, expands).severity), [Note, Missing], "{what}");
        }
    }

    #[test]
    fn a_keyword_is_in_the_table_once() {
        let mut all: Vec<&str> = TABLE.iter().flat_map(|(keywords, ..)| keywords.iter().copied()).collect();
        all.sort_unstable();
        assert!(all.windows(2).all(|pair| pair[0] != pair[1]));
        assert!(all.iter().all(|keyword| keyword_of(keyword) == *keyword));
    }
}
