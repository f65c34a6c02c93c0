// "did you mean": the known words nearest to one that is not known.
#pragma once

#include <string>
#include <vector>

namespace tessera {

// "; did you mean --quality?", or with up to three words; "" where none is near. Near is what differs
// by a letter in three, begins with the word, or holds it ("--psnr": "--target-psnr"); large and small
// letters are the same, two that are swapped count once.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& known);

} // namespace tessera
