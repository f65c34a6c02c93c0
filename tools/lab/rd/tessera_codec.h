// Our own codec, as the sweep sees it.
#pragma once

#include "tools/lab/rd/codec_under_test.h"

namespace tessera {

// Tessera at one effort. Settings are "psnr 38", "quality 62". The id is "tessera:<effort>".
CodecUnderTest tessera_codec(int effort, std::vector<std::string> settings);

} // namespace tessera
