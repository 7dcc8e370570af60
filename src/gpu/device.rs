//! An opened device: buffers, submissions, and errors as values.

use super::Adapter;
use crate::error::{Error, Result};
use bytemuck::{NoUninit, Pod};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A buffer of the device.
pub(crate) type Buffer = wgpu::Buffer;

/// How long a submission may take before the device counts as hung. Dispatches are sized to a tenth of a second.
const PATIENCE: Duration = Duration::from_secs(120);

/// An opened device. Its clones are the same device.
#[derive(Clone, Debug)]
pub struct Device {
    pub(super) device: wgpu::Device,
    queue: wgpu::Queue,
    /// The first thing that went wrong, from callbacks that may come at any time.
    failure: Arc<Mutex<Option<String>>>,
    /// Held by who submits or waits: wgpu panics where one thread finds a submission finished while another looks for it.
    one_at_a_time: Arc<Mutex<()>>,
    /// Does it compute in f64, and as accurately as kernels rely on? False once the self-test has found that it does not.
    f64: Arc<AtomicBool>,
    /// Has its driver passed the self-test? From then on kernels may do without the checks that wgpu adds.
    trusted: Arc<AtomicBool>,
    /// Is it a GPU in hardware?
    pub(crate) is_hardware: bool,
    /// Of the adapter.
    pub name: String,
    /// Limits that it was opened with: all that the adapter has.
    pub(crate) limits: wgpu::Limits,
}

/// A submission that may still be running.
#[derive(Clone, Debug)]
pub(crate) struct Wait(wgpu::SubmissionIndex);

impl Device {
    pub(super) fn open(adapter: &Adapter) -> Result<Self> {
        let refused = |problem: String| Error::Gpu { device: adapter.name.clone(), problem };
        let limits = adapter.adapter.limits();
        // wgpu does not compare workgroup memory with the limit, and an old driver may have less than WebGPU's least.
        if limits.max_storage_buffers_per_shader_stage < 8 || limits.max_compute_invocations_per_workgroup < 256 {
            return Err(refused("it has fewer than 8 storage buffers or 256 invocations per workgroup".to_owned()));
        }
        let f64 = adapter.adapter.features() & wgpu::Features::SHADER_F64;
        let wanted = wgpu::DeviceDescriptor {
            label: Some("beltspace"),
            required_features: f64,
            required_limits: limits.clone(),
            memory_hints: wgpu::MemoryHints::MemoryUsage,
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.adapter.request_device(&wanted))
            .map_err(|error| refused(format!("it cannot be opened: {error}")))?;
        let failure = Arc::new(Mutex::new(None));
        let keep = |failure: &Arc<Mutex<Option<String>>>| {
            let failure = Arc::clone(failure);
            move |problem: String| {
                failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(problem);
            }
        };
        let on_error = keep(&failure);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            on_error(match error {
                wgpu::Error::OutOfMemory { .. } => "it is out of memory".to_owned(),
                other => other.to_string().trim().replace('\n', " "),
            });
        }));
        let on_loss = keep(&failure);
        device.set_device_lost_callback(move |reason, message| on_loss(format!("it was lost ({reason:?}): {message}")));
        let f64 = Arc::new(AtomicBool::new(!f64.is_empty()));
        Ok(Self {
            device,
            queue,
            failure,
            one_at_a_time: Arc::default(),
            f64,
            trusted: Arc::default(),
            is_hardware: adapter.is_hardware(),
            name: adapter.name.clone(),
            limits,
        })
    }

    /// May kernels compute in f64?
    pub fn has_f64(&self) -> bool {
        self.f64.load(Ordering::Relaxed)
    }

    /// Kernels must do without f64 from now on.
    pub(crate) fn forgo_f64(&self) {
        self.f64.store(false, Ordering::Relaxed);
    }

    /// Has its driver passed the self-test?
    pub(super) fn is_trusted(&self) -> bool {
        self.trusted.load(Ordering::Relaxed)
    }

    /// Its driver has passed the self-test.
    pub(super) fn trust(&self) {
        self.trusted.store(true, Ordering::Relaxed);
    }

    /// An error of this device.
    pub(crate) fn error(&self, problem: impl Into<String>) -> Error {
        Error::Gpu { device: self.name.clone(), problem: problem.into() }
    }

    /// Has anything gone wrong so far?
    ///
    /// # Errors
    /// [`Error::Gpu`] with the first thing that did.
    pub(crate) fn check(&self) -> Result<()> {
        match &*self.failure.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(problem) => Err(self.error(problem.clone())),
            None => Ok(()),
        }
    }

    /// Gives the device up, as a driver does that loses it: every later call fails. For testing.
    pub fn lose(&self) {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(|| "it was lost (given up)".to_owned());
        self.device.destroy();
    }

    /// A buffer of `bytes`, at least 16, for what `usage` says; it can be written and read back.
    pub(crate) fn buffer(&self, label: &str, bytes: u64, usage: wgpu::BufferUsages) -> Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.max(16).next_multiple_of(16),
            usage: usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        })
    }

    /// A storage buffer that holds `values`.
    pub(crate) fn storage<T: NoUninit>(&self, label: &str, values: &[T]) -> Buffer {
        self.filled(label, values, wgpu::BufferUsages::STORAGE)
    }

    /// A uniform buffer that holds `values`.
    pub(crate) fn uniform<T: NoUninit>(&self, label: &str, values: &[T]) -> Buffer {
        self.filled(label, values, wgpu::BufferUsages::UNIFORM)
    }

    fn filled<T: NoUninit>(&self, label: &str, values: &[T], usage: wgpu::BufferUsages) -> Buffer {
        let buffer = self.buffer(label, std::mem::size_of_val(values) as u64, usage);
        self.write(&buffer, 0, values);
        buffer
    }

    /// Writes `values` at an offset in bytes, before whatever is submitted next.
    pub(crate) fn write<T: NoUninit>(&self, buffer: &Buffer, offset: u64, values: &[T]) {
        if !values.is_empty() {
            self.queue.write_buffer(buffer, offset, bytemuck::cast_slice(values));
        }
    }

    /// A buffer that results are copied to for reading.
    pub(crate) fn landing(&self, label: &str, bytes: u64) -> Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.max(16).next_multiple_of(16),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    }

    /// Submits what `record` records.
    pub(crate) fn submit(&self, record: impl FnOnce(&mut wgpu::CommandEncoder)) -> Wait {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        record(&mut encoder);
        let _one = self.one_at_a_time.lock().unwrap_or_else(PoisonError::into_inner);
        Wait(self.queue.submit([encoder.finish()]))
    }

    /// Waits until a submission has ended.
    ///
    /// # Errors
    /// [`Error::Gpu`] if it does not end, or something went wrong.
    pub(crate) fn wait(&self, submission: &Wait) -> Result<()> {
        let start = Instant::now();
        loop {
            let poll = wgpu::PollType::Wait { submission_index: Some(submission.0.clone()), timeout: Some(Duration::from_secs(1)) };
            let one = self.one_at_a_time.lock().unwrap_or_else(PoisonError::into_inner);
            let done = self.device.poll(poll);
            drop(one);
            self.check()?;
            match done {
                Ok(_) => return Ok(()),
                Err(wgpu::PollError::Timeout) if start.elapsed() < PATIENCE => {}
                Err(error) => return Err(self.error(format!("it does not answer: {error}"))),
            }
        }
    }

    /// The leading `count` values of a landing buffer, once the submission that fills it has ended.
    ///
    /// # Errors
    /// [`Error::Gpu`].
    pub(crate) fn read<T: Pod>(&self, landing: &Buffer, count: usize, submission: &Wait) -> Result<Vec<T>> {
        self.read_some(landing, count, submission, <[T]>::len)
    }

    /// The same, of which only as many leading values are copied as `used` says of them.
    ///
    /// # Errors
    /// [`Error::Gpu`].
    pub(crate) fn read_some<T: Pod>(
        &self,
        landing: &Buffer,
        count: usize,
        submission: &Wait,
        used: impl FnOnce(&[T]) -> usize,
    ) -> Result<Vec<T>> {
        let bytes = (count * size_of::<T>()) as u64;
        if count == 0 {
            return Ok(Vec::new());
        }
        let mapped = Arc::new(Mutex::new(None));
        let outcome = Arc::clone(&mapped);
        landing.map_async(wgpu::MapMode::Read, 0..bytes, move |result| {
            *outcome.lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
        });
        self.wait(submission)?;
        // The copy has ended; the callback comes with one more look at the device.
        let start = Instant::now();
        loop {
            match mapped.lock().unwrap_or_else(PoisonError::into_inner).take() {
                Some(Ok(())) => break,
                Some(Err(error)) => return Err(self.error(format!("its results cannot be read: {error}"))),
                None if start.elapsed() > PATIENCE => return Err(self.error("its results do not arrive")),
                None => {}
            }
            let _one = self.one_at_a_time.lock().unwrap_or_else(PoisonError::into_inner);
            self.device.poll(wgpu::PollType::Poll).map_err(|error| self.error(error.to_string()))?;
            self.check()?;
        }
        let range = landing.get_mapped_range(0..bytes).map_err(|error| self.error(format!("its results cannot be read: {error}")))?;
        let values: &[T] = bytemuck::cast_slice(&range);
        let values = values[..used(values)].to_vec();
        drop(range);
        landing.unmap();
        Ok(values)
    }

    /// Copies the leading `count` values of a buffer out of the device.
    ///
    /// # Errors
    /// [`Error::Gpu`].
    pub(crate) fn fetch<T: Pod>(&self, buffer: &Buffer, count: usize) -> Result<Vec<T>> {
        let bytes = ((count * size_of::<T>()) as u64).next_multiple_of(4);
        let landing = self.landing("fetch", bytes);
        let submission = self.submit(|encoder| encoder.copy_buffer_to_buffer(buffer, 0, &landing, 0, bytes));
        self.read(&landing, count, &submission)
    }
}
