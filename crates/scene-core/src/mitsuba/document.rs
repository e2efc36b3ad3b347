//! The scene file as typed objects: what is written, before what it means.

use std::cell::Cell;
use std::collections::HashMap;

use glam::DAffine3;

use super::error::{ImportError, Place, Result};

/// What an object is, from its element's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tag {
    Integrator,
    Sensor,
    Sampler,
    Film,
    Filter,
    Bsdf,
    Texture,
    Spectrum,
    Shape,
    Emitter,
    Medium,
    Phase,
    Volume,
}

impl Tag {
    const ALL: [(Self, &'static str); 13] = [
        (Self::Integrator, "integrator"),
        (Self::Sensor, "sensor"),
        (Self::Sampler, "sampler"),
        (Self::Film, "film"),
        (Self::Filter, "rfilter"),
        (Self::Bsdf, "bsdf"),
        (Self::Texture, "texture"),
        (Self::Spectrum, "spectrum"),
        (Self::Shape, "shape"),
        (Self::Emitter, "emitter"),
        (Self::Medium, "medium"),
        (Self::Phase, "phase"),
        (Self::Volume, "volume"),
    ];

    pub(super) fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, n)| *n == name).map(|&(tag, _)| tag)
    }

    pub(super) fn name(self) -> &'static str {
        Self::ALL.iter().find(|(tag, _)| *tag == self).map_or("object", |&(_, name)| name)
    }
}

/// The value of a property.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Float(f64),
    Integer(i64),
    Boolean(bool),
    String(String),
    Vector([f64; 3]),
    Rgb([f32; 3]),
    /// `<spectrum value="0.5"/>`.
    Uniform(f64),
    Spectrum(Vec<(f64, f64)>),
    Transform(DAffine3),
}

/// A named value.
#[derive(Clone, Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) value: Value,
    pub(super) place: Place,
    used: Cell<bool>,
}

impl Property {
    pub(super) fn new(name: String, value: Value, place: Place) -> Self {
        Self { name, value, place, used: Cell::new(false) }
    }
}

/// What a child is.
#[derive(Clone, Debug)]
pub(super) enum Target {
    /// Index of an object.
    Object(usize),
    /// The id of one, until [`Document::link`].
    Reference(String),
}

/// An object inside another.
#[derive(Clone, Debug)]
pub(super) struct Child {
    pub(super) name: String,
    pub(super) place: Place,
    target: Target,
    used: Cell<bool>,
}

impl Child {
    pub(super) fn new(name: String, target: Target, place: Place) -> Self {
        Self { name, place, target, used: Cell::new(false) }
    }
}

/// An instance of a plugin.
#[derive(Clone, Debug)]
pub(super) struct Object {
    pub(super) tag: Tag,
    pub(super) plugin: String,
    pub(super) place: Place,
    properties: Vec<Property>,
    children: Vec<Child>,
}

impl Object {
    pub(super) fn new(tag: Tag, plugin: String, place: Place) -> Self {
        Self { tag, plugin, place, properties: Vec::new(), children: Vec::new() }
    }

    fn check_name(&self, name: &str, place: &Place) -> Result<()> {
        let known = self.properties.iter().map(|p| &p.name).chain(self.children.iter().map(|c| &c.name));
        if !name.is_empty() && known.into_iter().any(|other| other == name) {
            return Err(place.invalid(format!("`{name}` is given twice")));
        }
        Ok(())
    }

    pub(super) fn add_property(&mut self, property: Property) -> Result<()> {
        if property.name.is_empty() {
            return Err(property.place.invalid("the value has no `name`"));
        }
        self.check_name(&property.name, &property.place)?;
        self.properties.push(property);
        Ok(())
    }

    pub(super) fn add_child(&mut self, child: Child) -> Result<()> {
        self.check_name(&child.name, &child.place)?;
        self.children.push(child);
        Ok(())
    }

    pub(super) fn take_property(&mut self, name: &str) -> Option<Property> {
        let index = self.properties.iter().position(|property| property.name == name)?;
        Some(self.properties.remove(index))
    }

    pub(super) fn replace_property(&mut self, property: Property) {
        self.take_property(&property.name);
        self.properties.push(property);
    }

    /// A property, marked as used.
    pub(super) fn property(&self, name: &str) -> Option<&Property> {
        let property = self.properties.iter().find(|property| property.name == name)?;
        property.used.set(true);
        Some(property)
    }

    /// Marks properties that have no meaning here, and need none.
    pub(super) fn ignore(&self, names: &[&str]) {
        for name in names {
            self.property(name);
        }
    }

    /// Marks everything as used.
    pub(super) fn ignore_all(&self) {
        self.properties.iter().for_each(|property| property.used.set(true));
        self.children.iter().for_each(|child| child.used.set(true));
    }

    /// Name and place of each property and child that nobody asked for.
    pub(super) fn unused(&self) -> impl Iterator<Item = (&str, &Place)> {
        let properties = self.properties.iter().filter(|p| !p.used.get()).map(|p| (p.name.as_str(), &p.place));
        properties.chain(self.children.iter().filter(|c| !c.used.get()).map(|c| (c.name.as_str(), &c.place)))
    }

    fn wrong_type(property: &Property, expected: &str) -> ImportError {
        property.place.invalid(format!("`{}` must be {expected}", property.name))
    }

    pub(super) fn float(&self, name: &str) -> Result<Option<f32>> {
        let Some(property) = self.property(name) else { return Ok(None) };
        let value = match property.value {
            Value::Float(value) => value,
            Value::Integer(value) => value as f64,
            _ => return Err(Self::wrong_type(property, "a number")),
        };
        let single = value as f32;
        if single.is_finite() { Ok(Some(single)) } else { Err(Self::wrong_type(property, "within single precision")) }
    }

    pub(super) fn integer(&self, name: &str) -> Result<Option<i64>> {
        match self.property(name) {
            None => Ok(None),
            Some(Property { value: Value::Integer(value), .. }) => Ok(Some(*value)),
            Some(property) => Err(Self::wrong_type(property, "an integer")),
        }
    }

    pub(super) fn boolean(&self, name: &str) -> Result<Option<bool>> {
        match self.property(name) {
            None => Ok(None),
            Some(Property { value: Value::Boolean(value), .. }) => Ok(Some(*value)),
            Some(property) => Err(Self::wrong_type(property, "a boolean")),
        }
    }

    pub(super) fn string(&self, name: &str) -> Result<Option<&str>> {
        match self.property(name) {
            None => Ok(None),
            Some(Property { value: Value::String(value), .. }) => Ok(Some(value)),
            Some(property) => Err(Self::wrong_type(property, "a string")),
        }
    }

    pub(super) fn vector(&self, name: &str) -> Result<Option<[f64; 3]>> {
        match self.property(name) {
            None => Ok(None),
            Some(Property { value: Value::Vector(value), .. }) => Ok(Some(*value)),
            Some(property) => Err(Self::wrong_type(property, "a vector or point")),
        }
    }

    pub(super) fn transform(&self, name: &str) -> Result<Option<DAffine3>> {
        match self.property(name) {
            None => Ok(None),
            Some(Property { value: Value::Transform(value), .. }) => Ok(Some(*value)),
            Some(property) => Err(Self::wrong_type(property, "a transform")),
        }
    }
}

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
