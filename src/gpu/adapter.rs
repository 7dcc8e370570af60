//! The adapters of this machine, and the choice of one.

use super::Device;
use crate::error::{Error, Result};

/// What an adapter is, best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AdapterKind {
    /// A graphics card with memory of its own.
    Discrete,
    /// A GPU that shares the memory of the machine.
    Integrated,
    /// A GPU of a virtual machine.
    Virtual,
    /// Of an unknown kind.
    Other,
    /// A program that does a GPU's work on the CPU, such as lavapipe.
    Software,
}

impl AdapterKind {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Discrete => "discrete GPU",
            Self::Integrated => "integrated GPU",
            Self::Virtual => "virtual GPU",
            Self::Other => "other",
            Self::Software => "software",
        }
    }
}

/// An adapter: a device of this machine as one of its drivers offers it.
#[derive(Clone, Debug)]
pub struct Adapter {
    pub(super) adapter: wgpu::Adapter,
    /// Its name, such as `llvmpipe (LLVM 15.0.6, 256 bits)`.
    pub name: String,
    /// What it is.
    pub kind: AdapterKind,
    /// Its driver and the driver's version.
    pub driver: String,
    /// The interface it is reached by: `Vulkan`, `Metal`, `Dx12`.
    pub backend: String,
}

impl Adapter {
    fn new(adapter: wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
            wgpu::DeviceType::IntegratedGpu => AdapterKind::Integrated,
            wgpu::DeviceType::VirtualGpu => AdapterKind::Virtual,
            wgpu::DeviceType::Other => AdapterKind::Other,
            wgpu::DeviceType::Cpu => AdapterKind::Software,
        };
        let driver = format!("{} {}", info.driver, info.driver_info).trim().to_owned();
        Self { name: info.name, kind, driver, backend: format!("{:?}", info.backend), adapter }
    }

    /// Is this kind of hardware likely to be faster than the CPU?
    pub fn is_hardware(&self) -> bool {
        matches!(self.kind, AdapterKind::Discrete | AdapterKind::Integrated | AdapterKind::Virtual)
    }

    /// The limits that matter here, by name.
    pub fn limits(&self) -> [(&'static str, u64); 5] {
        let limits = self.adapter.limits();
        [
            ("storage binding", limits.max_storage_buffer_binding_size),
            ("buffer", limits.max_buffer_size),
            ("uniform binding", limits.max_uniform_buffer_binding_size),
            ("invocations per workgroup", u64::from(limits.max_compute_invocations_per_workgroup)),
            ("workgroup memory", u64::from(limits.max_compute_workgroup_storage_size)),
        ]
    }

    /// In one line.
    pub fn in_words(&self) -> String {
        format!("{} ({}, {}, {})", self.name, self.kind.name(), self.backend, self.driver)
    }

    /// Opens it.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the driver refuses, or offers less than the kernels need.
    #[doc(hidden)]
    pub fn open(&self) -> Result<Device> {
        Device::open(self)
    }
}

/// All adapters that can compute, best kind first; of one kind in the drivers' order. Empty without a driver.
pub fn adapters() -> Vec<Adapter> {
    // Some platforms have no interface that is compiled in; making an instance there would panic.
    if wgpu::Instance::enabled_backend_features().is_empty() {
        return Vec::new();
    }
    let mut wanted = wgpu::InstanceDescriptor::new_without_display_handle();
    wanted.flags = wgpu::InstanceFlags::empty();
    let instance = wgpu::Instance::new(wanted);
    let found = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    let needed = wgpu::DownlevelFlags::COMPUTE_SHADERS | wgpu::DownlevelFlags::INDIRECT_EXECUTION;
    let computes = |adapter: &wgpu::Adapter| adapter.get_downlevel_capabilities().flags.contains(needed);
    let mut adapters: Vec<_> = found.into_iter().filter(computes).map(Adapter::new).collect();
    adapters.sort_by_key(|adapter| adapter.kind);
    adapters
}

/// The best adapter, or the best of those whose name contains `name`, whatever the case of the letters.
///
/// # Errors
/// [`Error::NoAdapter`] that lists what there is.
pub fn choose(name: Option<&str>) -> Result<Adapter> {
    let adapters = adapters();
    if adapters.is_empty() {
        return Err(Error::NoAdapter { name: name.map(str::to_owned), there: Vec::new() });
    }
    let wanted = name.unwrap_or_default().to_lowercase();
    match adapters.iter().find(|adapter| adapter.name.to_lowercase().contains(&wanted)) {
        Some(adapter) => Ok(adapter.clone()),
        None => {
            let there = adapters.into_iter().map(|adapter| adapter.name).collect();
            Err(Error::NoAdapter { name: name.map(str::to_owned), there })
        }
    }
}
