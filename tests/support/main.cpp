// main() of the test programs: runs gtest and also reports tests that take more than a second of
// CPU time, including their threads and child processes. Wall-clock time says little on a busy
// machine.
#include <cstdio>
#include <gtest/gtest.h>
#ifdef _WIN32
#include <ctime>
#else
#include <sys/resource.h>
#endif

namespace {

#ifdef _WIN32

// Wall-clock time, which is what this C library measures.
double seconds_of_this_process_and_its_children() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

#else

double seconds_of(int who) {
    rusage usage = {};
    getrusage(who, &usage);
    const auto in_seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
    };
    return in_seconds(usage.ru_utime);
}

double seconds_of_this_process_and_its_children() {
    return seconds_of(RUSAGE_SELF) + seconds_of(RUSAGE_CHILDREN);
}

#endif

class CpuTimes : public testing::EmptyTestEventListener {
    void OnTestSuiteStart(const testing::TestSuite&) override { suite_began_ = now(); }
    void OnTestStart(const testing::TestInfo&) override { began_ = now(); }
    void OnTestEnd(const testing::TestInfo& test) override {
        const double seconds = now() - began_;
        if (seconds >= 1)
            std::printf("[ CPU time ] %5.1f s: %s.%s\n", seconds, test.test_suite_name(),
                        test.name());
    }
    void OnTestSuiteEnd(const testing::TestSuite& suite) override {
        const double seconds = now() - suite_began_;
        if (seconds >= 1)
            std::printf("[ CPU time ] %5.1f s: %s, with its fixtures\n", seconds, suite.name());
    }
    static double now() { return seconds_of_this_process_and_its_children(); }

    double suite_began_ = 0, began_ = 0;
};

} // namespace

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    testing::UnitTest::GetInstance()->listeners().Append(new CpuTimes); // takes ownership
    return RUN_ALL_TESTS();
}
