// What the decoder needs from a device, and a check of the current context.
#pragma once

#include "format/status.h"

#include <cstdint>

namespace tessera {

// Limits as OpenGL counts them: what a device offers, or the least that the decoder needs. The
// defaults are what the decoder needs.
struct DeviceLimits {
    std::int64_t version = 45;                            // OpenGL, 45 is 4.5
    std::int64_t group_invocations = 128;                 // threads of a work group
    std::int64_t group_size_x = 128;                      // threads along x
    std::int64_t group_count_x = 65535;                   // groups of a dispatch
    std::int64_t group_count_y = 65535;                   //
    std::int64_t group_count_z = 65535;                   //
    std::int64_t shared_bytes = 32 * 1024;                // of a work group
    std::int64_t storage_block_bytes = 128 * 1024 * 1024; // one storage buffer
    std::int64_t compute_storage_blocks = 8;              // buffers that a compute shader sees
    std::int64_t combined_storage_blocks = 8;             // buffers that all stages see together
    std::int64_t storage_bindings = 8;                    //
    std::int64_t compute_images = 2;                      // images that a compute shader sees
    std::int64_t image_units = 2;                         //
    std::int64_t texture_size = 2048;                     // texels along a side
    std::int64_t texture_layers = 2048;                   //
};

// Ok, or unsupported with a message that names every limit of `offered` below `needed`. Pure.
Status check_limits(const DeviceLimits& offered, const DeviceLimits& needed);

// Both need a context that is current on this thread. Below OpenGL 4.3 all limits but the version
// are 0.
DeviceLimits current_limits();
Status check_device();

} // namespace tessera
