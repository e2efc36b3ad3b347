//! Buffers, views of them, and typed accessors: every read is checked against the bytes that are there.

use std::path::Path;

use ::gltf::Accessor;
use ::gltf::accessor::{DataType, Dimensions};

use super::document::Source;
use super::error::{Place, Result};
use super::uri;

/// Elements of an accessor without data are zero, and nothing but this bounds their number.
const MOST_ZEROS: usize = 1 << 24;

/// The bytes of all buffers.
#[derive(Debug)]
pub(super) struct Buffers {
    buffers: Vec<Vec<u8>>,
}

impl Buffers {
    pub(super) fn read(source: &mut Source, directory: &Path) -> Result<Self> {
        // For the first buffer alone.
        let mut binary = source.binary.take();
        let mut buffers = Vec::new();
        for (buffer, index) in source.document.as_json().buffers.iter().zip(0..) {
            let place = source.place("buffers", index, buffer.name.as_deref());
            let chunk = binary.take().filter(|_| index == 0);
            let bytes = match &buffer.uri {
                Some(uri) => uri::read(uri, directory, &place)?.0,
                None => chunk.ok_or_else(|| place.invalid("it has no `uri`, and there is no binary chunk for it"))?,
            };
            let promised = buffer.byte_length.0;
            if (bytes.len() as u64) < promised {
                return Err(place.invalid(format!("it promises {promised} bytes and has {}", bytes.len())));
            }
            buffers.push(bytes);
        }
        Ok(Self { buffers })
    }

    /// The bytes of a view.
    pub(super) fn view(&self, source: &Source, index: usize) -> Result<&[u8]> {
        let views = &source.document.as_json().buffer_views;
        let place = source.place("bufferViews", index, views.get(index).and_then(|view| view.name.as_deref()));
        let view = views.get(index).ok_or_else(|| place.invalid("there is no such view"))?;
        let buffer = self.buffers.get(view.buffer.value()).ok_or_else(|| place.invalid("it has no buffer"))?;
        let (start, length) = (view.byte_offset.map_or(0, |offset| offset.0), view.byte_length.0);
        let bytes = start.checked_add(length).and_then(|end| buffer.get(start as usize..end as usize));
        let outside = || format!("{length} bytes from {start} on are not within its buffer of {}", buffer.len());
        bytes.ok_or_else(|| place.invalid(outside()))
    }

    /// Vectors of floats. Integers are taken as they are or, if the accessor says so, normalised (section 3.11).
    pub(super) fn floats<const N: usize>(&self, source: &Source, accessor: &Accessor<'_>) -> Result<Vec<[f32; N]>> {
        let normalized = accessor.normalized();
        self.elements(source, accessor, |kind, bytes| Some(float(kind, bytes, normalized)))
    }

    /// Indices: unsigned integers.
    pub(super) fn indices(&self, source: &Source, accessor: &Accessor<'_>) -> Result<Vec<u32>> {
        let elements = self.elements::<u32, 1>(source, accessor, |kind, bytes| match (kind, bytes) {
            (DataType::U8, &[a]) => Some(u32::from(a)),
            (DataType::U16, &[a, b]) => Some(u32::from(u16::from_le_bytes([a, b]))),
            (DataType::U32, &[a, b, c, d]) => Some(u32::from_le_bytes([a, b, c, d])),
            _ => None,
        })?;
        Ok(elements.into_iter().map(|[index]| index).collect())
    }

    fn elements<T: Copy + Default, const N: usize>(
        &self,
        source: &Source,
        accessor: &Accessor<'_>,
        convert: impl Fn(DataType, &[u8]) -> Option<T>,
    ) -> Result<Vec<[T; N]>> {
        let place = source.place("accessors", accessor.index(), accessor.name());
        let (kind, dimensions, count) = (accessor.data_type(), accessor.dimensions(), accessor.count());
        let is_vector = !matches!(dimensions, Dimensions::Mat2 | Dimensions::Mat3 | Dimensions::Mat4);
        if !is_vector || dimensions.multiplicity() != N {
            return Err(place.invalid(format!("its type is {dimensions:?}, where {N} components are needed")));
        }
        let mut elements = match accessor.view() {
            Some(view) => {
                let layout = Layout { kind, count, offset: accessor.offset(), stride: view.stride() };
                layout.read(self.view(source, view.index())?, &place, &convert)?
            }
            None if count > MOST_ZEROS => {
                return Err(place.invalid(format!("{count} elements without a view are too many")));
            }
            None => vec![[T::default(); N]; count],
        };
        let Some(sparse) = accessor.sparse() else { return Ok(elements) };
        // Some of the elements are replaced.
        let (indices, values) = (sparse.indices(), sparse.values());
        let index_kind = match indices.index_type() {
            ::gltf::accessor::sparse::IndexType::U8 => DataType::U8,
            ::gltf::accessor::sparse::IndexType::U16 => DataType::U16,
            ::gltf::accessor::sparse::IndexType::U32 => DataType::U32,
        };
        let count = sparse.count();
        let layout = Layout { kind: index_kind, count, offset: indices.offset(), stride: None };
        let index = |kind: DataType, bytes: &[u8]| Some(unsigned(kind, bytes));
        let at: Vec<[usize; 1]> = layout.read(self.view(source, indices.view().index())?, &place, &index)?;
        let layout = Layout { kind, count, offset: values.offset(), stride: None };
        let values = layout.read(self.view(source, values.view().index())?, &place, &convert)?;
        for ([at], value) in at.into_iter().zip(values) {
            let length = elements.len();
            let element = elements.get_mut(at);
            *element.ok_or_else(|| place.invalid(format!("sparse element {at} is not below {length}")))? = value;
        }
        Ok(elements)
    }
}

/// Where elements lie in a view.
struct Layout {
    kind: DataType,
    count: usize,
    offset: usize,
    stride: Option<usize>,
}

impl Layout {
    fn read<T: Copy + Default, const N: usize>(
        &self,
        bytes: &[u8],
        place: &Place,
        convert: &impl Fn(DataType, &[u8]) -> Option<T>,
    ) -> Result<Vec<[T; N]>> {
        let Self { kind, count, offset, stride } = *self;
        if count == 0 {
            return Ok(Vec::new());
        }
        let size = kind.size();
        let stride = stride.filter(|stride| *stride > 0).unwrap_or(N * size);
        let last = (count - 1).checked_mul(stride).and_then(|length| length.checked_add(offset));
        let end = last.and_then(|last| last.checked_add(N * size));
        if end.is_none_or(|end| end > bytes.len()) {
            let message = format!("{count} elements of {} bytes, {stride} apart, from {offset} on", N * size);
            return Err(place.invalid(format!("{message} are not within its view of {} bytes", bytes.len())));
        }
        let mut elements = vec![[T::default(); N]; count];
        for (element, index) in elements.iter_mut().zip(0..) {
            let start = offset + index * stride;
            for (component, bytes) in element.iter_mut().zip(bytes[start..].chunks_exact(size)) {
                let converted = convert(kind, bytes);
                *component =
                    converted.ok_or_else(|| place.invalid(format!("components of type {kind:?} are no indices")))?;
            }
        }
        Ok(elements)
    }
}

fn unsigned(kind: DataType, bytes: &[u8]) -> usize {
    bytes[..kind.size()].iter().rev().fold(0, |index, byte| index << 8 | usize::from(*byte))
}

fn float(kind: DataType, bytes: &[u8], normalized: bool) -> f32 {
    let short = || [bytes[0], bytes[1]];
    let word = || [bytes[0], bytes[1], bytes[2], bytes[3]];
    let (value, largest) = match kind {
        DataType::I8 => (f32::from(bytes[0] as i8), 127.0),
        DataType::U8 => (f32::from(bytes[0]), 255.0),
        DataType::I16 => (f32::from(i16::from_le_bytes(short())), 32_767.0),
        DataType::U16 => (f32::from(u16::from_le_bytes(short())), 65_535.0),
        DataType::U32 => (u32::from_le_bytes(word()) as f32, u32::MAX as f32),
        DataType::F32 => return f32::from_le_bytes(word()),
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}
