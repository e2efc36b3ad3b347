//! The hierarchy of nodes, flattened.

use ::gltf::Node;
use ::gltf::scene::Transform;
use glam::{Affine3A, DAffine3, DMat4, DQuat, DVec3, Mat3A};

use super::error::{Place, Result};
use super::importer::Importer;

/// A node and where it is.
pub(super) struct Placed<'s> {
    pub(super) node: Node<'s>,
    pub(super) to_world: Affine3A,
    pub(super) place: Place,
}

/// The nodes of the default scene (of the first one, or all that are no children, if there is none), parents before children, in the
/// order of the document. Transforms are multiplied in f64.
///
/// The specification asks for trees. A node that is met twice would be a cycle or have two parents, and is an error.
pub(super) fn placed<'s>(importer: &mut Importer<'s>) -> Result<Vec<Placed<'s>>> {
    let source = importer.source;
    let document = &source.document;
    let mut nodes: Vec<Option<Node<'s>>> = document.nodes().map(Some).collect();
    let scene = document.default_scene().or_else(|| document.scenes().next());
    let roots: Vec<usize> = match &scene {
        Some(scene) => scene.nodes().map(|node| node.index()).collect(),
        None => {
            let mut is_child = vec![false; nodes.len()];
            document.nodes().flat_map(|node| node.children()).for_each(|child| is_child[child.index()] = true);
            (0..nodes.len()).filter(|&index| !is_child[index]).collect()
        }
    };
    if document.scenes().len() > 1
        && let Some(scene) = &scene
    {
        let place = source.place("scenes", scene.index(), scene.name());
        importer.warn(&place, format!("of {} scenes this one is taken", document.scenes().len()));
    }
    // A stack in place of recursion, so that no depth can exceed that of the program's.
    let mut stack: Vec<(usize, DAffine3)> = roots.into_iter().rev().map(|root| (root, DAffine3::IDENTITY)).collect();
    let mut placed = Vec::new();
    while let Some((index, parent)) = stack.pop() {
        let name = document.as_json().nodes.get(index).and_then(|node| node.name.as_deref());
        let place = source.place("nodes", index, name);
        let Some(node) = nodes.get_mut(index).and_then(Option::take) else {
            return Err(
                place.invalid("the node is in the hierarchy twice: nodes must not share children or form a cycle")
            );
        };
        let to_world = parent * local(&node, &place)?;
        if node.skin().is_some() {
            importer.warn(&place, "ignored: the skin");
        }
        let first = stack.len();
        stack.extend(node.children().map(|child| (child.index(), to_world)));
        stack[first..].reverse();
        let matrix3 = Mat3A::from(to_world.matrix3.as_mat3());
        let to_world = Affine3A { matrix3, translation: to_world.translation.as_vec3a() };
        if !to_world.is_finite() {
            return Err(place.invalid("its place in the world exceeds single precision"));
        }
        placed.push(Placed { node, to_world, place });
    }
    Ok(placed)
}

/// From a node to its parent: a matrix, or scale, rotation and translation in this order.
fn local(node: &Node<'_>, place: &Place) -> Result<DAffine3> {
    match node.transform() {
        Transform::Matrix { matrix } => {
            let columns = matrix.map(|column| column.map(f64::from));
            let matrix = DMat4::from_cols_array_2d(&columns);
            let last = matrix.row(3).to_array();
            if !matrix.is_finite() || last.iter().zip([0.0, 0.0, 0.0, 1.0]).any(|(x, y)| (x - y).abs() > 1e-6) {
                return Err(place.invalid(format!("its matrix is not affine: the last row is {last:?}")));
            }
            Ok(DAffine3::from_mat4(matrix))
        }
        Transform::Decomposed { translation, rotation, scale } => {
            let (translation, scale) = (DVec3::from(translation.map(f64::from)), DVec3::from(scale.map(f64::from)));
            let quaternion = DQuat::from_array(rotation.map(f64::from));
            let length = quaternion.length();
            if !(length > 0.0 && length.is_finite() && translation.is_finite() && scale.is_finite()) {
                let message = format!("translation {translation}, rotation {rotation:?} and scale {scale}");
                return Err(place.invalid(message + " make no transform"));
            }
            Ok(DAffine3::from_scale_rotation_translation(scale, quaternion.normalize(), translation))
        }
    }
}
