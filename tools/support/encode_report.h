// What an encode achieved, for people and for programs.
#pragma once

#include "codec/encoder.h"
#include "tools/support/json_text.h"

#include <cstdio>
#include <string>

namespace tessera {

// Encodes into the file `path`, whose folders are made; "-": to standard output, without a journal.
// Errors: those of encode_file, with how to resume; io.
Result<EncodeReport> encode_to(TexelSource& source, const std::string& path,
                               const EncodeOptions& options);

// target_missed, where the file that was written is not as good as was asked.
Status check_target(const std::string& path, const EncodeOptions& options,
                    const EncodeReport& report);

void print_report(std::FILE* to, const std::string& path, const TextureDesc& desc,
                  const EncodeReport& report);

// "psnr" is null where the file is lossless; "target_met": whether the rate that was asked for was
// reached.
Json report_json(const std::string& path, const TextureDesc& desc, const EncodeOptions& options,
                 const EncodeReport& report);

} // namespace tessera
