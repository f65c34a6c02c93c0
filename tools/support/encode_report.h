// The result of an encode, for people and for programs.
#pragma once

#include "codec/encoder.h"
#include "tools/support/json_text.h"
#include "tools/support/warnings.h"

#include <cstdio>
#include <string>

namespace tessera {

// Encodes into the file `path` and creates its folders. "-" is standard output, without a journal.
// Errors: those of encode_file, with a hint to --resume; io.
Result<EncodeReport> encode_to(TexelSource& source, const std::string& path,
                               const EncodeOptions& options);

// Errors: target_missed, if the written file does not reach its target.
Status check_target(const std::string& path, const EncodeOptions& options,
                    const EncodeReport& report);

// Counts the samples that the encoder replaced.
void count_replaced(const EncodeReport& report, Warnings& warnings);

void print_report(std::FILE* to, const std::string& path, const TextureDesc& desc,
                  const EncodeReport& report);

// "psnr" is null if the file is lossless. "target_met" says whether the file reaches its target.
Json report_json(const std::string& path, const TextureDesc& desc, const EncodeOptions& options,
                 const EncodeReport& report);

} // namespace tessera
