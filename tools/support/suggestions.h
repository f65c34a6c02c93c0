// "Did you mean ...?": the known words that are most like an unknown one.
#pragma once

#include <string>
#include <vector>

namespace tessera {

// "; did you mean --quality?", with up to three words; "" if no known word is like `word`. A word
// is like it if at most a third of the letters differ, or if it contains it ("--psnr":
// "--target-psnr"). Case does not matter; swapping two neighbours is one difference.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& known);

} // namespace tessera
