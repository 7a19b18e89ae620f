//! The way from the closest facet to the signed gap: faces, edges, vertices and rims.

use super::view::Foot;
use super::{Feature, MasterPoint, Pairing, SearchView};
use nalgebra::Vector3;
use stoss_geometry::PatchFeature;
use stoss_reference_element::FacetNodes;

/// What surrounds the closest point on an edge or vertex.
struct Surroundings {
    /// Sum of the facets' normals, weighted by their angles.
    pseudo_normal: Vector3<f64>,
    /// The facet whose normal is best aligned with the direction to the point, and the closest point's coordinates there.
    aligned: (u32, [f64; 2]),
    alignment: f64,
    rim: bool,
}

impl SearchView<'_> {
    /// Signed gap, feature and pairing that belong to a foot.
    pub(super) fn resolve(&self, x: &Vector3<f64>, foot: &Foot, slave_normal: Option<&Vector3<f64>>) -> MasterPoint {
        let Foot { facet, closest } = *foot;
        let direction = x - closest.point;
        match closest.feature {
            PatchFeature::Interior => {
                let normal = self.patch(facet).normal(closest.xi);
                let gap = direction.dot(&normal);
                let pairing = Some(Pairing { facet, xi: closest.xi, gap, normal });
                let feature = Feature::Face { facet, xi: closest.xi };
                MasterPoint { feature, gap, normal, point: closest.point, pairing }
            }
            PatchFeature::Edge(edge) => {
                let (around, neighbour) = self.around_edge(foot, edge, &direction, slave_normal);
                let feature = Feature::Edge { facets: (facet, neighbour), xi: closest.xi };
                self.on_boundary_of_facets(x, foot, feature, &around, slave_normal)
            }
            PatchFeature::Vertex(corner) => {
                let local = self.search.surface.local_facets()[facet as usize][corner] as usize;
                let around = self.around_vertex(foot, local, &direction, slave_normal);
                let feature = Feature::Vertex { node: self.search.surface.nodes()[local], rim: around.rim };
                self.on_boundary_of_facets(x, foot, feature, &around, slave_normal)
            }
        }
    }

    fn around_edge(
        &self,
        foot: &Foot,
        edge: usize,
        direction: &Vector3<f64>,
        slave_normal: Option<&Vector3<f64>>,
    ) -> (Surroundings, Option<u32>) {
        let surface = &self.search.surface;
        let own = self.patch(foot.facet).normal(foot.closest.xi);
        let mut around = Surroundings {
            pseudo_normal: own,
            aligned: (foot.facet, foot.closest.xi),
            alignment: direction.dot(&own).abs(),
            rim: true,
        };
        let accepted = surface.neighbour(foot.facet, edge).and_then(|neighbour| {
            let facets = [foot.facet, neighbour].map(|f| &surface.facets()[f as usize]);
            let xi = across_edge(foot.closest.xi, edge, facets[0], facets[1])?;
            let normal = self.patch(neighbour).normal(xi);
            self.opposes(neighbour, &normal, slave_normal).then_some((neighbour, xi, normal))
        });
        if let Some((neighbour, xi, normal)) = accepted {
            around.rim = false;
            around.add(neighbour, xi, normal, 1.0, direction);
        }
        (around, accepted.map(|a| a.0))
    }

    fn around_vertex(
        &self,
        foot: &Foot,
        local_node: usize,
        direction: &Vector3<f64>,
        slave_normal: Option<&Vector3<f64>>,
    ) -> Surroundings {
        let surface = &self.search.surface;
        let own = self.patch(foot.facet).normal(foot.closest.xi);
        let mut around = Surroundings {
            pseudo_normal: Vector3::zeros(),
            aligned: (foot.facet, foot.closest.xi),
            alignment: direction.dot(&own).abs(),
            rim: false,
        };
        for &facet in surface.facets_around(local_node) {
            let patch = self.patch(facet);
            let corners = &surface.local_facets()[facet as usize];
            let Some(corner) = corners.iter().position(|&n| n as usize == local_node) else { continue };
            let xi = patch.kind().vertices()[corner];
            let normal = patch.normal(xi);
            if facet != foot.facet && !self.opposes(facet, &normal, slave_normal) {
                around.rim = true;
                continue;
            }
            around.add(facet, xi, normal, patch.corner_angle(corner), direction);
            around.rim |=
                [corner, corners.kind().previous(corner)].iter().any(|&edge| surface.neighbour(facet, edge).is_none());
        }
        around
    }

    /// Gap on an edge or vertex: the distance with the pseudo-normal's sign, or on a rim the gap of the extended facet.
    fn on_boundary_of_facets(
        &self,
        x: &Vector3<f64>,
        foot: &Foot,
        feature: Feature,
        around: &Surroundings,
        slave_normal: Option<&Vector3<f64>>,
    ) -> MasterPoint {
        let (facet, start) = around.aligned;
        let projection = self.patch(facet).project(x, start);
        let point = foot.closest.point;
        let direction = x - point;
        let pairing = if projection.converged {
            Pairing { facet, xi: projection.xi, gap: projection.gap, normal: projection.normal }
        } else {
            // No foot on the extension (a point far from a tapered facet): the closest point itself serves.
            let normal = self.patch(facet).normal(start);
            Pairing { facet, xi: start, gap: direction.dot(&normal), normal }
        };
        let distance = direction.norm();
        let sign = if direction.dot(&around.pseudo_normal) < 0.0 { -1.0 } else { 1.0 };
        // Below this the direction is noise.
        let resolvable = 1e-10 * self.search.surface.length_scale();
        let normal = if distance > resolvable {
            direction * (sign / distance)
        } else {
            around.pseudo_normal.try_normalize(1e-12).unwrap_or(pairing.normal)
        };
        let beyond = if around.rim { self.beyond_rim(facet, start, projection.xi, slave_normal) } else { None };
        match beyond {
            Some(excess) if !(projection.converged && excess <= self.search.options.overhang) => {
                MasterPoint { feature, gap: f64::INFINITY, normal, point, pairing: None }
            }
            Some(_) => MasterPoint { feature, gap: pairing.gap, normal: pairing.normal, point, pairing: Some(pairing) },
            None => MasterPoint { feature, gap: sign * distance, normal, point, pairing: Some(pairing) },
        }
    }

    /// How far `xi` lies beyond those edges of the facet that touch the closest point `start` and end the surface; `None` if no edge does.
    fn beyond_rim(
        &self,
        facet: u32,
        start: [f64; 2],
        xi: [f64; 2],
        slave_normal: Option<&Vector3<f64>>,
    ) -> Option<f64> {
        let surface = &self.search.surface;
        let kind = surface.facets()[facet as usize].kind();
        let ends_at = |edge: usize| match surface.neighbour(facet, edge) {
            None => true,
            Some(neighbour) => {
                let facets = [facet, neighbour].map(|f| &surface.facets()[f as usize]);
                let there = across_edge(start, edge, facets[0], facets[1]);
                there.is_none_or(|xi| !self.opposes(neighbour, &self.patch(neighbour).normal(xi), slave_normal))
            }
        };
        (0..kind.edge_count())
            .filter(|&edge| kind.edge_excess(edge, start) == 0.0 && ends_at(edge))
            .map(|edge| kind.edge_excess(edge, xi))
            .reduce(f64::max)
    }
}

impl Surroundings {
    fn add(&mut self, facet: u32, xi: [f64; 2], normal: Vector3<f64>, weight: f64, direction: &Vector3<f64>) {
        self.pseudo_normal += normal * weight;
        let alignment = direction.dot(&normal).abs();
        // Only a clearly better facet replaces the first one: in a smooth surface all are equal up to round-off.
        if alignment > self.alignment * (1.0 + 1e-9) {
            (self.aligned, self.alignment) = ((facet, xi), alignment);
        }
    }
}

/// Coordinates on a neighbour of a point on edge `edge` of `facet`, which runs the other way round there.
fn across_edge(xi: [f64; 2], edge: usize, facet: &FacetNodes, neighbour: &FacetNodes) -> Option<[f64; 2]> {
    let along = facet.kind().along_edge(edge, xi);
    let end = neighbour.iter().position(|&n| n == facet[edge])?;
    let kind = neighbour.kind();
    Some(kind.on_edge(kind.previous(end), -along))
}
