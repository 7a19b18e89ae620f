//! Quantities of probes, and fields of the frames.

use crate::names::named;

named! {
    /// Quantity that a probe records.
    Quantity {
        /// Displacement from the reference position (length); of a set the mean over its nodes.
        Displacement = "displacement",
        /// Current position (length); of a set the mean over its nodes.
        Position = "position",
        /// Velocity; of a set the mean over its nodes. Dynamic scenes only.
        Velocity = "velocity",
        /// Reaction force of prescribed displacements on the body; of a set the sum over its nodes. Zero in components that are not prescribed, and without the forces of `[[support]]`.
        Reaction = "reaction",
        /// Moment of the reaction forces about the origin, at the current positions.
        ReactionMoment = "reaction_moment",
        /// Force of the elastic supports (`[[support]]`), springs and dashpots, on the body at the end of the step; of a set the sum over its nodes.
        SupportForce = "support_force",
        /// Contact force on the body; of a set the sum over its nodes, of a rigid body the resultant.
        ContactForce = "contact_force",
        /// Moment of the contact forces about the origin, at the current positions.
        ContactMoment = "contact_moment",
        /// Force of a joint on the first of its parts.
        JointForce = "joint_force",
        /// Moment of a joint on the first of its parts, about the joint's point on it.
        JointMoment = "joint_moment",
        /// Relative angle of a hinge, cylindrical or universal joint in degrees; may exceed 360.
        JointAngle = "joint_angle",
        /// Relative displacement of a slider (length); of a bolt with pretension, the opening of its cut.
        JointDisplacement = "joint_displacement",
        /// Multiplier of an equation (force): the force on each of its terms is the multiplier times the factor, positive along its direction; of an equation for each node of sets the sum.
        EquationForce = "equation_force",
        /// Elevation angle of the velocity above the x-y plane in degrees, positive towards z; of a set that of the mean velocity. Dynamic scenes only.
        Elevation = "elevation",
        /// Angular velocity of a rigid body (radians per time). Dynamic scenes only.
        AngularVelocity = "angular_velocity",
        /// Cauchy stress at a material point: `.xx .yy .zz .xy .yz .xz`.
        CauchyStress = "cauchy_stress",
        /// Green-Lagrange strain `(F^T F - 1)/2` at a material point: `.xx .yy .zz .xy .yz .xz`.
        GreenLagrangeStrain = "green_lagrange_strain",
        /// Logarithmic strain `ln(F F^T)/2` at a material point, in current directions: `.xx .yy .zz .xy .yz .xz`.
        LogarithmicStrain = "logarithmic_strain",
        /// Principal Cauchy stresses at a material point, the largest first: `.1 .2 .3`.
        PrincipalStresses = "principal_stresses",
        /// Von Mises stress at a material point.
        VonMises = "von_mises",
        /// Equivalent plastic strain at a material point of a body that yields.
        EquivalentPlasticStrain = "equivalent_plastic_strain",
        /// Plastic strain at a material point of a body that yields, logarithmic, in reference directions: `.xx .yy .zz .xy .yz .xz`.
        PlasticStrain = "plastic_strain",
        /// Back stress at a material point of a body with a `kinematic_modulus`, in reference directions: `.xx .yy .zz .xy .yz .xz`.
        BackStress = "back_stress",
        /// Share of the Gauss points of the element that have yielded in the step, 0 to 1, of a body that yields.
        Yielding = "yielding",
        /// Viscous strain at a material point of a body with `prony`, logarithmic, in reference directions, the mean of the branches by their moduli: `.xx .yy .zz .xy .yz .xz`.
        ViscousStrain = "viscous_strain",
        /// Deformation gradient at a material point, first index current, second index reference direction: `.xx .xy .xz .yx` and so on.
        DeformationGradient = "deformation_gradient",
        /// Kinetic plus strain energy of a body, or of the whole model.
        Energy = "energy",
        /// Kinetic energy of a body, or of the whole model. Dynamic scenes only.
        KineticEnergy = "kinetic_energy",
        /// Strain energy of a body, or of the whole model.
        StrainEnergy = "strain_energy",
        /// Linear momentum of a body, or of the whole model. Dynamic scenes only.
        LinearMomentum = "linear_momentum",
        /// Angular momentum about the origin of a body, or of the whole model. Dynamic scenes only.
        AngularMomentum = "angular_momentum",
    }
}

impl Quantity {
    /// True if it belongs to nodes (and needs `set`, or `body` and `point`, or a rigid `body`), false if to a part, to everything or to a joint.
    pub fn is_nodal(self) -> bool {
        matches!(
            self,
            Self::Displacement
                | Self::Position
                | Self::Velocity
                | Self::Elevation
                | Self::Reaction
                | Self::ReactionMoment
                | Self::SupportForce
                | Self::ContactForce
                | Self::ContactMoment
        )
    }

    /// True if it is a sum over the model, as forces and energies are: in scenes of plane sections that of a unit of thickness or of a radian.
    pub fn is_integral(self) -> bool {
        matches!(
            self,
            Self::Reaction
                | Self::ReactionMoment
                | Self::SupportForce
                | Self::ContactForce
                | Self::ContactMoment
                | Self::JointForce
                | Self::JointMoment
                | Self::EquationForce
                | Self::Energy
                | Self::KineticEnergy
                | Self::StrainEnergy
                | Self::LinearMomentum
                | Self::AngularMomentum
        )
    }

    /// True if it belongs to a joint.
    pub fn is_of_joint(self) -> bool {
        matches!(self, Self::JointForce | Self::JointMoment | Self::JointAngle | Self::JointDisplacement)
    }

    /// True if it belongs to an equation.
    pub fn is_of_equation(self) -> bool {
        self == Self::EquationForce
    }

    /// True if it has a meaning only with inertia.
    pub fn is_dynamic(self) -> bool {
        matches!(
            self,
            Self::Velocity
                | Self::Elevation
                | Self::AngularVelocity
                | Self::KineticEnergy
                | Self::LinearMomentum
                | Self::AngularMomentum
        )
    }

    /// True if it belongs to a material point of a deformable body: needs `body` and `point`, and is what the element's interpolation gives there.
    pub fn is_of_material(self) -> bool {
        matches!(
            self,
            Self::CauchyStress
                | Self::GreenLagrangeStrain
                | Self::LogarithmicStrain
                | Self::PrincipalStresses
                | Self::VonMises
                | Self::DeformationGradient
        ) || self.is_of_state()
    }

    /// True if it is of the state of a material with history, and only bodies with such a material have it. Its name is that of the material's output.
    pub fn is_of_state(self) -> bool {
        matches!(
            self,
            Self::EquivalentPlasticStrain
                | Self::PlasticStrain
                | Self::BackStress
                | Self::Yielding
                | Self::ViscousStrain
        )
    }

    /// True if it may have a [`Extremum`]: it has a value at each node. Stresses and strains are then those of the frames, extrapolated to nodes.
    pub fn has_extrema(self) -> bool {
        matches!(
            self,
            Self::Displacement
                | Self::Position
                | Self::Velocity
                | Self::Reaction
                | Self::ContactForce
                | Self::CauchyStress
                | Self::GreenLagrangeStrain
                | Self::LogarithmicStrain
                | Self::PrincipalStresses
                | Self::VonMises
        ) || self.is_of_state()
    }

    /// Names of its components in the order of their columns; empty for one value: energies, angles, coordinates of joints, von Mises stress.
    pub fn components(self) -> &'static [ProbeComponent] {
        use ProbeComponent::{First, Second, Third, X, Xx, Xy, Xz, Y, Yx, Yy, Yz, Z, Zx, Zy, Zz};
        match self {
            Self::Energy
            | Self::KineticEnergy
            | Self::StrainEnergy
            | Self::JointAngle
            | Self::EquationForce
            | Self::JointDisplacement
            | Self::Elevation
            | Self::VonMises
            | Self::EquivalentPlasticStrain
            | Self::Yielding => &[],
            Self::PrincipalStresses => &[First, Second, Third],
            Self::CauchyStress
            | Self::GreenLagrangeStrain
            | Self::LogarithmicStrain
            | Self::PlasticStrain
            | Self::BackStress
            | Self::ViscousStrain => &[Xx, Yy, Zz, Xy, Yz, Xz],
            Self::DeformationGradient => &[Xx, Xy, Xz, Yx, Yy, Yz, Zx, Zy, Zz],
            _ => &[X, Y, Z],
        }
    }

    /// Number of values: 1, or that of its components.
    pub fn columns(self) -> usize {
        self.components().len().max(1)
    }
}

named! {
    /// Component of a vector or tensor.
    ProbeComponent {
        /// Of a vector, along x.
        X = "x",
        /// Of a vector, along y.
        Y = "y",
        /// Of a vector, along z.
        Z = "z",
        /// The largest principal value.
        First = "1",
        /// The middle principal value.
        Second = "2",
        /// The smallest principal value.
        Third = "3",
        /// Of a tensor, row x, column x.
        Xx = "xx",
        /// Row x, column y.
        Xy = "xy",
        /// Row x, column z.
        Xz = "xz",
        /// Row y, column x.
        Yx = "yx",
        /// Row y, column y.
        Yy = "yy",
        /// Row y, column z.
        Yz = "yz",
        /// Row z, column x.
        Zx = "zx",
        /// Row z, column y.
        Zy = "zy",
        /// Row z, column z.
        Zz = "zz",
    }
}

named! {
    /// Extremum over the nodes of a set or body that a probe records.
    Extremum {
        /// The largest.
        Max = "max",
        /// The smallest.
        Min = "min",
    }
}

named! {
    /// Field in the frames.
    Field {
        /// Displacement of the nodes (length).
        Displacement = "displacement",
        /// Velocity of the nodes.
        Velocity = "velocity",
        /// Cauchy stress, extrapolated to nodes.
        CauchyStress = "cauchy_stress",
        /// Von Mises stress.
        VonMises = "von_mises",
        /// Equivalent plastic strain, extrapolated to nodes; scenes with a material that yields only. Zero on other bodies.
        EquivalentPlasticStrain = "equivalent_plastic_strain",
        /// Plastic strain, logarithmic, in reference directions, extrapolated to nodes; scenes with a material that yields only. Only if named in `fields`.
        PlasticStrain = "plastic_strain",
        /// Back stress of kinematic hardening in reference directions, extrapolated to nodes; scenes with a `kinematic_modulus` only. Only if named in `fields`.
        BackStress = "back_stress",
        /// Share of the Gauss points around a node that have yielded in the last step, 0 to 1; scenes with a material that yields only. Only if named in `fields`.
        Yielding = "yielding",
        /// Viscous strain of materials with `prony`, logarithmic, in reference directions, the mean of the branches by their moduli, extrapolated to nodes; scenes with such a material only. Only if named in `fields`.
        ViscousStrain = "viscous_strain",
        /// Principal Cauchy stresses, the largest first. Only if named in `fields`.
        PrincipalStresses = "principal_stresses",
        /// Deformation gradient `F`, extrapolated to nodes, in the order xx, xy, xz, yx, ...: first the current direction, then the reference
        /// direction. Only if named in `fields`.
        DeformationGradient = "deformation_gradient",
        /// Green-Lagrange strain `(F^T F - 1)/2`, extrapolated to nodes; shears are tensor components. Only if named in `fields`.
        GreenLagrangeStrain = "green_lagrange_strain",
        /// Logarithmic strain `ln V = ln(F F^T)/2` in the current directions, extrapolated to nodes; shears are tensor components. Only if named in `fields`.
        LogarithmicStrain = "logarithmic_strain",
        /// Force of prescribed displacements on each node, zero where nothing is prescribed. Only if named in `fields`.
        Reaction = "reaction",
        /// Contact pressure on slave nodes, positive in compression; of general contact on all surfaces, as a mean since the last frame.
        ContactPressure = "contact_pressure",
        /// Pressures of the equations, of which `contact_pressure` is a mean on quadratic faces of mortar contact; elsewhere the same. Only if named in `fields`.
        ContactMultiplier = "contact_multiplier",
        /// Gap of slave nodes (length), positive if open; of general contact the distance to the nearest other surface.
        Gap = "gap",
        /// Contact status of slave nodes: 0 open, 1 stick, 2 slip (also without friction); the largest where a node has several constraints.
        ContactStatus = "contact_status",
        /// Magnitude of the friction traction, per current area; scenes with friction only.
        FrictionTraction = "friction_traction",
        /// Magnitude of the slip of the slave relative to the master in the last step (length); scenes with friction only.
        Slip = "slip",
    }
}

impl Field {
    /// Whether frames have it where the scene names no fields.
    pub fn is_default(self) -> bool {
        !matches!(
            self,
            Self::PrincipalStresses
                | Self::DeformationGradient
                | Self::GreenLagrangeStrain
                | Self::LogarithmicStrain
                | Self::Reaction
                | Self::ContactMultiplier
                | Self::PlasticStrain
                | Self::BackStress
                | Self::Yielding
                | Self::ViscousStrain
        )
    }

    /// True if it is of the state of a material with history, and only bodies with such a material have it. Its name is that of the material's output.
    pub fn is_of_state(self) -> bool {
        Quantity::from_name(self.name()).is_some_and(Quantity::is_of_state)
    }
}
