//! The scene file as typed objects: what is written, before what it means.

use std::collections::HashMap;

use super::error::{ImportError, Place, Result};
use super::object::{Child, Object, Tag, Target};

/// All objects of a scene.
#[derive(Debug, Default)]
pub(super) struct Document {
    pub(super) objects: Vec<Object>,
    /// Top-level objects in the order of the files.
    pub(super) roots: Vec<usize>,
    pub(super) ids: HashMap<String, usize>,
}

impl Document {
    pub(super) fn define(&mut self, id: String, object: usize, place: &Place) -> Result<()> {
        if let Some(&other) = self.ids.get(&id) {
            let first = &self.objects[other].place;
            return Err(place.invalid(format!("the id `{id}` is taken already, at {first}")));
        }
        self.ids.insert(id, object);
        Ok(())
    }

    /// Resolves references, and rejects objects that contain themselves.
    pub(super) fn link(&mut self) -> Result<()> {
        for object in &mut self.objects {
            for child in &mut object.children {
                if let Target::Reference(id) = &child.target {
                    let Some(&index) = self.ids.get(id) else {
                        return Err(ImportError::UnresolvedReference { place: child.place.clone(), id: id.clone() });
                    };
                    child.target = Target::Object(index);
                }
            }
        }
        let mut state = vec![Visit::New; self.objects.len()];
        (0..self.objects.len()).try_for_each(|index| self.check_acyclic(index, &mut state))
    }

    /// Depth-first search with its own stack, so that no chain of references is too long for it.
    fn check_acyclic(&self, start: usize, state: &mut [Visit]) -> Result<()> {
        if state[start] != Visit::New {
            return Ok(());
        }
        state[start] = Visit::Open;
        let mut stack = vec![(start, 0)];
        while let Some((index, next)) = stack.pop() {
            let Some(child) = self.objects[index].children.get(next) else {
                state[index] = Visit::Done;
                continue;
            };
            stack.push((index, next + 1));
            let target = self.target(child);
            match state[target] {
                Visit::Open => return Err(child.place.invalid("the object contains itself")),
                Visit::Done => {}
                Visit::New => {
                    state[target] = Visit::Open;
                    stack.push((target, 0));
                }
            }
        }
        Ok(())
    }

    fn target(&self, child: &Child) -> usize {
        match &child.target {
            Target::Object(index) => *index,
            // `link` has replaced it.
            Target::Reference(id) => self.ids[id],
        }
    }

    /// The children with one of these tags, marked as used.
    pub(super) fn children<'a>(
        &'a self,
        object: &'a Object,
        tags: &'a [Tag],
    ) -> impl Iterator<Item = (&'a Child, usize)> + 'a {
        let with_index = object.children.iter().map(|child| (child, self.target(child)));
        with_index
            .filter(|&(_, index)| tags.contains(&self.objects[index].tag))
            .inspect(|(child, _)| child.used.set(true))
    }

    /// The child of that name, marked as used.
    pub(super) fn child(&self, object: &Object, name: &str) -> Option<usize> {
        let child = object.children.iter().find(|child| child.name == name)?;
        child.used.set(true);
        Some(self.target(child))
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Visit {
    New,
    Open,
    Done,
}
