//! Welding, and the check that a surface is closed and consistently oriented.

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
/// vertices of no triangle. Dropping such a triangle keeps edges balanced: it meets one edge once each way.
pub(super) fn weld(vertices: &[[f64; 3]], triangles: &[[u32; 3]], times: &[i32]) -> Mesh {
    const UNUSED: u32 = u32::MAX;
    let mut first_at = HashMap::with_capacity(vertices.len());
    let canonical: Vec<u32> =
        (0_u32..).zip(vertices).map(|(i, v)| *first_at.entry(v.map(|x| (x + 0.0).to_bits())).or_insert(i)).collect();
    let mut mesh = Mesh { vertices: Vec::new(), triangles: Vec::new(), times: Vec::new(), faces: Vec::new() };
    let mut used = vec![false; vertices.len()];
    for ((face, t), &times) in (0_u32..).zip(triangles).zip(times) {
        let [a, b, c] = t.map(|i| canonical[i as usize]);
        if a != b && b != c && c != a {
            mesh.triangles.push([a, b, c]);
            mesh.times.push(times);
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

/// Checks that every undirected edge is met equally often in each direction, a triangle counted as often as it stands.
pub(super) fn check_closed(mesh: &Mesh) -> Result<()> {
    // (undirected edge, triangle and direction): sorting brings the uses of an edge together.
    let mut uses: Vec<(u64, u32)> = Vec::with_capacity(3 * mesh.triangles.len());
    for (t, triangle) in (0_u32..).zip(&mesh.triangles) {
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            uses.push((u64::from(a.min(b)) << 32 | u64::from(a.max(b)), t << 1 | u32::from(a > b)));
        }
    }
    uses.sort_unstable();
    let times = |use_: u32| i64::from(mesh.times[(use_ >> 1) as usize]);
    let balance =
        |uses: &[(u64, u32)]| uses.iter().map(|u| if u.1 & 1 == 0 { times(u.1) } else { -times(u.1) }).sum::<i64>();
    let unbalanced = |uses: &&[(u64, u32)]| balance(uses) != 0;
    // The one of the lowest face, so that the message does not depend on how vertices are numbered.
    match uses.chunk_by(|u, v| u.0 == v.0).filter(unbalanced).min_by_key(|uses| uses[0].1) {
        Some(uses) => Err(edge_error(mesh, uses)),
        None => Ok(()),
    }
}

fn edge_error(mesh: &Mesh, uses: &[(u64, u32)]) -> Error {
    let (edge, first) = uses[0];
    let ends = [mesh.vertices[(edge >> 32) as usize], mesh.vertices[(edge & 0xffff_ffff) as usize]];
    let same = uses.iter().filter(|u| u.1 & 1 == first & 1).count();
    let (from, to) = if first & 1 == 0 { (ends[0], ends[1]) } else { (ends[1], ends[0]) };
    let triangle = mesh.faces[(first >> 1) as usize];
    let place = format!("the edge from {from:?} to {to:?} of triangle {triangle} (from 0)");
    let what = match (uses.len(), same) {
        (1, _) => format!("the domain's surface is open: {place} belongs to no other triangle; close the hole"),
        (n, _) if n % 2 == 1 => format!(
            "the domain's surface is open: {place} belongs to {n} triangles, which must be an even number; remove the \
             sheet that ends there or close it"
        ),
        (n, same) => format!(
            "the domain's triangles are not consistently oriented: {place} is met {same} times in this direction and {} \
             times in the other, which must be equal; orient the triangles alike",
            n - same
        ),
    };
    Error::input(what).of_triangle(triangle as usize)
}
