//! Welding, and the check that a surface is closed.

use std::collections::HashMap;

use crate::{Error, Result};

/// A mesh whose vertices are distinct and all used, and whose triangles have three different vertices each.
pub(super) struct Mesh {
    pub(super) vertices: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// How often each of them stands.
    pub(super) times: Vec<i32>,
    /// For every triangle its number in the caller's list.
    faces: Vec<u32>,
}

/// One vertex for each position (−0 is 0), without the triangles that then have two equal vertices and without the
/// vertices of no triangle, each as often as is said, or once. Dropping such a triangle keeps edges balanced: it meets one edge once each way.
pub(super) fn weld(vertices: &[[f64; 3]], triangles: &[[u32; 3]], times: Option<&[i32]>) -> Mesh {
    const UNUSED: u32 = u32::MAX;
    let mut first_at = HashMap::with_capacity(vertices.len());
    let canonical: Vec<u32> =
        (0_u32..).zip(vertices).map(|(i, v)| *first_at.entry(v.map(|x| (x + 0.0).to_bits())).or_insert(i)).collect();
    let mut mesh = Mesh { vertices: Vec::new(), triangles: Vec::new(), times: Vec::new(), faces: Vec::new() };
    let mut used = vec![false; vertices.len()];
    for (face, t) in (0_u32..).zip(triangles) {
        let [a, b, c] = t.map(|i| canonical[i as usize]);
        if a != b && b != c && c != a {
            mesh.triangles.push([a, b, c]);
            mesh.times.push(times.map_or(1, |times| times[face as usize]));
            mesh.faces.push(face);
            [a, b, c].into_iter().for_each(|i| used[i as usize] = true);
        }
    }
    let mut new_index = vec![UNUSED; vertices.len()];
    for (i, v) in vertices.iter().enumerate().filter(|&(i, _)| used[i]) {
        new_index[i] = mesh.vertices.len() as u32;
        mesh.vertices.push(v.map(|x| x + 0.0));
    }
    mesh.triangles.iter_mut().flatten().for_each(|i| *i = new_index[*i as usize]);
    mesh
}

/// The edges of a mesh, one entry for each triangle that meets one: the edge, as its lower and its higher vertex, and twice the triangle, plus
/// one where it goes from the higher to the lower. Sorted, which brings the uses of an edge together.
pub(super) struct Edges(Vec<(u64, u32)>);

impl Edges {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let mut uses = Vec::with_capacity(3 * mesh.triangles.len());
        for (t, triangle) in (0_u32..).zip(&mesh.triangles) {
            for k in 0..3 {
                let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
                uses.push((u64::from(a.min(b)) << 32 | u64::from(a.max(b)), t << 1 | u32::from(a > b)));
            }
        }
        uses.sort_unstable();
        Self(uses)
    }

    /// The vertices of every edge, and its uses.
    pub(super) fn iter(&self) -> impl Iterator<Item = ([u32; 2], &[(u64, u32)])> {
        self.0.chunk_by(|u, v| u.0 == v.0).map(|uses| ([(uses[0].0 >> 32) as u32, uses[0].0 as u32], uses))
    }

    /// Whether every edge is met equally often in each direction.
    pub(super) fn are_balanced(&self) -> bool {
        self.iter().all(|(_, uses)| 2 * uses.iter().filter(|u| u.1 & 1 == 0).count() == uses.len())
    }
}

/// Checks that every edge belongs to an even number of triangles.
pub(super) fn check_closed(mesh: &Mesh, edges: &Edges) -> Result<()> {
    // The one of the lowest face, so that the message does not depend on how vertices are numbered.
    let odd = edges.iter().filter(|(_, uses)| uses.len() % 2 == 1).min_by_key(|(_, uses)| uses[0].1);
    let Some((_, uses)) = odd else { return Ok(()) };
    let (place, triangle) = place_of(mesh, uses[0]);
    let what = match uses.len() {
        1 => format!("{place} belongs to no other triangle; close the hole"),
        n => format!(
            "{place} belongs to {n} triangles, which must be an even number; remove the sheet that ends there or close it"
        ),
    };
    Err(Error::input(format!("the domain's surface is open: {what}")).of_triangle(triangle))
}

/// The words for an edge as one triangle meets it, and that triangle by the caller's count.
pub(super) fn place_of(mesh: &Mesh, (edge, first): (u64, u32)) -> (String, usize) {
    let [low, high] = [(edge >> 32) as usize, (edge & 0xffff_ffff) as usize].map(|i| mesh.vertices[i]);
    let (from, to) = if first & 1 == 0 { (low, high) } else { (high, low) };
    let triangle = mesh.faces[(first >> 1) as usize] as usize;
    (format!("the edge from {from:?} to {to:?} of triangle {triangle} (from 0)"), triangle)
}
