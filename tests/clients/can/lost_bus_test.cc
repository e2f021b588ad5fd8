// A vendor's CAN library without its bus: what a program is told.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "clients/canlib/ntcan.h"

namespace {

// A bus that nobody is on. VISUM_CAN leads to it.
class EmptyBus {
 public:
  EmptyBus() : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* any = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(fd_, any, size), 0);
    EXPECT_EQ(::listen(fd_, 1), 0);
    EXPECT_EQ(::getsockname(fd_, any, &size), 0);
    ::setenv("VISUM_CAN", ("127.0.0.1:" + std::to_string(ntohs(address.sin_port))).c_str(), 1);
  }
  ~EmptyBus() { ::close(fd_); }
  int accept() const { return ::accept(fd_, nullptr, nullptr); }

 private:
  int fd_;
};

class Ntcan : public testing::TestWithParam<int32_t> {};

TEST_P(Ntcan, ABusThatIsGoneIsNoTimeOut) {
  const EmptyBus bus;
  NTCAN_HANDLE handle = -1;
  ASSERT_EQ(canOpen(0, 0, 10, 10, 100, GetParam(), &handle), NTCAN_SUCCESS);
  const int client = bus.accept();
  CMSG message;
  int32_t count = 1;
  EXPECT_EQ(canTake(handle, &message, &count), NTCAN_SUCCESS);
  EXPECT_EQ(count, 0);
  char opening[4];
  ASSERT_EQ(::recv(client, opening, sizeof opening, MSG_WAITALL), 4);
  ::close(client);
  for (int i = 0; i < 2; ++i) {
    count = 1;
    EXPECT_EQ(canRead(handle, &message, &count, nullptr), NTCAN_CONTR_OFF_BUS);
    EXPECT_EQ(count, 0);
  }
  count = 1;
  EXPECT_EQ(canTake(handle, &message, &count), NTCAN_CONTR_OFF_BUS);
  EXPECT_EQ(canClose(handle), NTCAN_SUCCESS);
}
INSTANTIATE_TEST_SUITE_P(CanLibrary, Ntcan, testing::Values(0, 20'000),
                         [](const auto& info) { return info.param == 0 ? "ForEver" : "ForAWhile"; });

TEST(CanLine, AnAddressThatIsNoneIsToldAsSuch) {
  constexpr const char* kNoPort = "no-such-port";
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo("127.0.0.1", kNoPort, &hints, &found);
  ASSERT_NE(error, 0);
  ::setenv("VISUM_CAN", (std::string("127.0.0.1:") + kNoPort).c_str(), 1);
  testing::internal::CaptureStderr();
  NTCAN_HANDLE handle = -1;
  EXPECT_EQ(canOpen(0, 0, 10, 10, 100, 100, &handle), NTCAN_NET_NOT_FOUND);
  EXPECT_EQ(
      testing::internal::GetCapturedStderr(),
      std::string("libntcan (Visum): no bus at 127.0.0.1:no-such-port: ") + ::gai_strerror(error) + "\n");
}

}  // namespace
