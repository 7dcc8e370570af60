//! A kernel's text made into pipelines, with everything checked before the driver sees it.

use super::{Buffer, Device};
use crate::error::Result;
use wgpu::naga;

/// What a binding is, as the text declares it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Binding {
    /// Name of the variable.
    pub name: String,
    /// Its number.
    pub number: u32,
    /// How it is bound.
    kind: wgpu::BufferBindingType,
}

/// A kernel: text, bindings found in it by reflection, and one pipeline per entry point.
#[derive(Debug)]
pub(crate) struct Program {
    device: Device,
    module: naga::Module,
    bindings: Vec<Binding>,
    layout: wgpu::BindGroupLayout,
    pipelines: Vec<(String, wgpu::ComputePipeline)>,
}

/// Parses and validates a kernel.
///
/// # Errors
/// What is wrong with the text, with a line of it.
fn parse(source: &str) -> std::result::Result<naga::Module, String> {
    parsed(source).map(|(module, _)| module)
}

/// The same with what the validation has found out of it.
///
/// # Errors
/// As [`parse`].
pub(super) fn parsed(source: &str) -> std::result::Result<(naga::Module, naga::valid::ModuleInfo), String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::FLOAT64);
    let info = validator.validate(&module).map_err(|error| error.emit_to_string(source))?;
    Ok((module, info))
}

/// The bindings that a kernel declares.
fn bindings(module: &naga::Module) -> Vec<Binding> {
    let bound = module.global_variables.iter().filter_map(|(_, variable)| {
        let number = variable.binding?.binding;
        let kind = match variable.space {
            naga::AddressSpace::Uniform => wgpu::BufferBindingType::Uniform,
            naga::AddressSpace::Storage { access } => {
                wgpu::BufferBindingType::Storage { read_only: !access.contains(naga::StorageAccess::STORE) }
            }
            _ => return None,
        };
        Some(Binding { name: variable.name.clone().unwrap_or_default(), number, kind })
    });
    let mut bindings: Vec<_> = bound.collect();
    bindings.sort_by_key(|binding| binding.number);
    bindings
}

/// Bytes of a structure of the kernel, and the offset of each of its members by name.
fn structure(module: &naga::Module, name: &str) -> Option<(u32, Vec<(String, u32)>)> {
    module.types.iter().find(|(_, it)| it.name.as_deref() == Some(name)).and_then(|(_, it)| match &it.inner {
        naga::TypeInner::Struct { members, span } => {
            let members = members.iter().map(|member| (member.name.clone().unwrap_or_default(), member.offset));
            Some((*span, members.collect()))
        }
        _ => None,
    })
}

/// Bytes of workgroup memory that a kernel takes.
fn workgroup_memory(module: &naga::Module) -> u32 {
    let shared = module.global_variables.iter().filter(|(_, variable)| variable.space == naga::AddressSpace::WorkGroup);
    shared.map(|(_, variable)| module.types[variable.ty].inner.size(module.to_ctx())).sum()
}

impl Program {
    /// Compiles the entry points of a kernel.
    ///
    /// # Errors
    /// [`Error::Gpu`](crate::error::Error::Gpu) with what naga or the driver says.
    pub(crate) fn new(device: &Device, source: &str, entries: &[&str]) -> Result<Self> {
        Self::made(device, source, entries, |text| device.device.create_shader_module(text))
    }

    /// The same. Where the driver has passed the self-test, kernels do without the checks of indices, loops and divisions that wgpu adds.
    ///
    /// # Safety
    /// With what the buffers hold when it is dispatched, every index is below the length of its array, every loop ends, and no integer is
    /// divided by zero.
    ///
    /// # Errors
    /// As [`Program::new`].
    #[allow(unsafe_code, reason = "wgpu has no other way to leave its checks out")]
    pub(crate) unsafe fn without_checks(device: &Device, source: &str, entries: &[&str]) -> Result<Self> {
        if !device.is_trusted() {
            return Self::new(device, source, entries);
        }
        Self::made(device, source, entries, |text| {
            // SAFETY: what the caller promises of the text is what wgpu asks for.
            unsafe { device.device.create_shader_module_trusted(text, wgpu::ShaderRuntimeChecks::unchecked()) }
        })
    }

    fn made(
        device: &Device,
        source: &str,
        entries: &[&str],
        module_of: impl FnOnce(wgpu::ShaderModuleDescriptor<'_>) -> wgpu::ShaderModule,
    ) -> Result<Self> {
        let module = parse(source).map_err(|problem| device.error(format!("a kernel does not compile: {problem}")))?;
        let memory = workgroup_memory(&module);
        if memory > device.limits.max_compute_workgroup_storage_size {
            let limit = device.limits.max_compute_workgroup_storage_size;
            return Err(device.error(format!("a kernel needs {memory} bytes of workgroup memory, the limit is {limit}")));
        }
        let bindings = bindings(&module);
        let gpu = &device.device;
        let entry = |binding: &Binding| wgpu::BindGroupLayoutEntry {
            binding: binding.number,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty: binding.kind, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        // An explicit layout: bindings that an entry point does not use would be missing from an automatic one.
        let layout = gpu.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &bindings.iter().map(entry).collect::<Vec<_>>(),
        });
        let pipeline_layout =
            gpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor { bind_group_layouts: &[Some(&layout)], ..Default::default() });
        let shader = module_of(wgpu::ShaderModuleDescriptor { label: Some("kernel"), source: wgpu::ShaderSource::Wgsl(source.into()) });
        let pipeline = |entry: &&str| {
            let pipeline = gpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: Some(&pipeline_layout),
                module: &shader,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
            ((*entry).to_owned(), pipeline)
        };
        let pipelines = entries.iter().map(pipeline).collect();
        device.check()?;
        Ok(Self { device: device.clone(), module, bindings, layout, pipelines })
    }

    /// The text and the program must mean the same by a structure: size, names and offsets of its members.
    ///
    /// # Errors
    /// [`Error::Gpu`](crate::error::Error::Gpu) with the first difference.
    pub(crate) fn require_structure(&self, name: &str, size: usize, members: &[(&str, usize)]) -> Result<()> {
        let wrong = |what: String| Err(self.device.error(format!("the kernel and the program differ in {name}: {what}")));
        let Some((span, found)) = structure(&self.module, name) else { return wrong("the kernel has none".to_owned()) };
        if span as usize != size {
            return wrong(format!("{span} bytes in the kernel, {size} in the program"));
        }
        let same = |((a, at), (b, of)): (&(String, u32), &(&str, usize))| a == b && *at as usize == *of;
        if found.len() != members.len() || !found.iter().zip(members).all(same) {
            return wrong(format!("{found:?} in the kernel, {members:?} in the program"));
        }
        Ok(())
    }

    /// Binds buffers to the variables of these names: all that the kernel declares.
    ///
    /// # Panics
    /// If a variable is left out: the kernel and the caller were written for each other.
    pub(crate) fn bind(&self, buffers: &[(&str, &Buffer)]) -> wgpu::BindGroup {
        let entry = |binding: &Binding| {
            let (_, buffer) = buffers.iter().find(|(name, _)| *name == binding.name).expect("every variable of a kernel is bound");
            wgpu::BindGroupEntry { binding: binding.number, resource: buffer.as_entire_binding() }
        };
        self.device.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.layout,
            entries: &self.bindings.iter().map(entry).collect::<Vec<_>>(),
        })
    }

    /// Records one dispatch of an entry point over so many workgroups.
    ///
    /// # Panics
    /// If the entry point was not compiled.
    pub(crate) fn dispatch(&self, encoder: &mut wgpu::CommandEncoder, entry: &str, bound: &wgpu::BindGroup, groups: [u32; 2]) {
        self.pass(encoder, entry, bound).dispatch_workgroups(groups[0], groups[1], 1);
    }

    /// The same over as many workgroups as three words of a buffer say by then. `groups`: the buffer, and the byte where these words begin.
    ///
    /// # Panics
    /// If the entry point was not compiled.
    pub(crate) fn dispatch_counted(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        entry: &str,
        bound: &wgpu::BindGroup,
        groups: (&Buffer, u64),
    ) {
        self.pass(encoder, entry, bound).dispatch_workgroups_indirect(groups.0, groups.1);
    }

    fn pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, entry: &str, bound: &wgpu::BindGroup) -> wgpu::ComputePass<'e> {
        let (_, pipeline) = self.pipelines.iter().find(|(name, _)| name == entry).expect("the entry point was compiled");
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, bound, &[]);
        pass
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "struct S { a: u32, b: vec3<f32>, c: f32 }\n@group(0) @binding(1) var<uniform> s: S;\n\
        @group(0) @binding(0) var<storage, read_write> out: array<f32>;\nvar<workgroup> shared_: array<f32, 100>;\n\
        @compute @workgroup_size(1) fn f() { shared_[0] = s.c; out[0] = shared_[0]; }";

    #[test]
    fn a_text_is_reflected() {
        let module = parse(TEXT).expect("the text is right");
        let names: Vec<_> = bindings(&module).into_iter().map(|it| (it.number, it.name)).collect();
        assert_eq!(names, [(0, "out".to_owned()), (1, "s".to_owned())]);
        let (size, members) = structure(&module, "S").expect("it is there");
        assert_eq!((size, members[1].1, members[2].1), (32, 16, 28), "WGSL aligns a vec3 to 16 bytes");
        assert_eq!(workgroup_memory(&module), 400);
    }

    #[test]
    fn a_wrong_text_is_refused_with_its_line() {
        let wrong = TEXT.replace("s.c", "s.d");
        assert!(parse(&wrong).expect_err("there is no d").contains("invalid field"), "{:?}", parse(&wrong));
    }
}
