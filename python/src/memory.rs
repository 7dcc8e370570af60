//! Memory for the numbers of long columns, in large pages where the system has them, as numpy has it. With small pages, touching them for
//! the first time took half of the time of an evaluation with all outputs.

use arrow_buffer::{Buffer, ScalarBuffer};
use memmap2::MmapMut;
use std::ptr::NonNull;
use std::sync::Arc;

/// Bytes from which on a column has pages of its own.
const LONG: usize = 4 << 20;

/// Room for the numbers of a column, zero at first.
pub enum ColumnRoom {
    Short(Vec<f64>),
    /// With the number of numbers.
    Long(MmapMut, usize),
}

impl ColumnRoom {
    pub fn new(rows: usize) -> Self {
        let bytes = rows * size_of::<f64>();
        let pages = (bytes >= LONG).then(|| MmapMut::map_anon(bytes).ok()).flatten();
        let Some(pages) = pages else { return Self::Short(vec![0.0; rows]) };
        // A request that the system may refuse: then it only takes longer.
        #[cfg(target_os = "linux")]
        let _ = pages.advise(memmap2::Advice::HugePage);
        Self::Long(pages, rows)
    }

    /// The numbers, to be written.
    pub fn numbers(&mut self) -> &mut [f64] {
        match self {
            Self::Short(numbers) => numbers,
            Self::Long(pages, rows) => bytemuck::cast_slice_mut(&mut pages[..*rows * size_of::<f64>()]),
        }
    }

    /// The same memory as Arrow and numpy have it.
    pub fn into_buffer(self) -> ScalarBuffer<f64> {
        match self {
            Self::Short(numbers) => numbers.into(),
            Self::Long(mut pages, rows) => {
                let (bytes, start) = (rows * size_of::<f64>(), NonNull::from(&mut pages[0]));
                // SAFETY: the pages are at least that long, and are where they are until the buffer drops what owns them.
                let buffer = unsafe { Buffer::from_custom_allocation(start, bytes, Arc::new(pages)) };
                ScalarBuffer::new(buffer, 0, rows)
            }
        }
    }
}
