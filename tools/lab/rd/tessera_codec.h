// Our own codec, as the sweep sees it.
#pragma once

#include "tools/lab/rd/codec_under_test.h"

namespace tessera {

// At one effort. Settings are "psnr 38", "quality 62". The id is "tessera:<effort>". `tools`: as
// --tools; a run fails where it is wrong.
CodecUnderTest tessera_codec(int effort, std::vector<std::string> settings,
                             const std::string& tools = "");

} // namespace tessera
