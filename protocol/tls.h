// TLS 1.3 with certificates on both sides, as a filter between the bytes of a connection and its plain text:
// no socket, no thread, no clock of its own. OpenSSL stays inside tls.cc.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace visum::protocol {

// PEM files. All three, or none.
struct TlsFiles {
  std::string authority;    // certificates of those who may sign the peer's
  std::string certificate;  // our own, with the chain that leads to an authority
  std::string key;          // its private key, ours alone to read
  bool given() const { return !authority.empty() || !certificate.empty() || !key.empty(); }
};

// What clients use where nobody says otherwise: $VISUM_TLS_CA, $VISUM_TLS_CERT, $VISUM_TLS_KEY.
TlsFiles tls_files_of_environment();

// Keys and rules that all connections of a side share. Any thread, once made.
class TlsContext {
 public:
  enum class Side { kServer, kClient };

  // Throws std::runtime_error naming the file that is missing, wrong, or (a key) open to others.
  TlsContext(const TlsFiles& files, Side side);
  ~TlsContext();
  TlsContext(const TlsContext&) = delete;
  TlsContext& operator=(const TlsContext&) = delete;

 private:
  friend class TlsStream;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// One connection. One thread. Never throws for what a peer sends: failure() says what was wrong with it.
class TlsStream {
 public:
  // The context must outlive it. `host`: for a client, the name or address that the server's certificate must
  // be for.
  explicit TlsStream(const TlsContext& context, const std::string& host = {});
  ~TlsStream();

  // From the network. Then read(), which is what works on it.
  void feed(std::span<const std::byte> bytes);
  // Plain text; 0: more has to be fed, or it has ended, or failed.
  std::size_t read(std::span<std::byte> into);
  // Plain text to be sent; how much of it was taken: none before it is established.
  std::size_t write(std::span<const std::byte> bytes);
  // Says goodbye; nothing may be written after it.
  void finish();

  // For the network: what of it was sent has to be told.
  std::span<const std::byte> pending();
  void sent(std::size_t bytes);

  bool established() const;                                // both have shown their certificates
  bool ended() const { return ended_; }                    // the peer said goodbye
  const std::string& failure() const { return failure_; }  // empty: none
  std::string peer_name() const;                           // the common name in the peer's certificate

 private:
  struct Impl;
  bool advance();  // the handshake; true once it is over
  void note(int result);

  std::unique_ptr<Impl> impl_;
  std::vector<std::byte> out_;
  std::size_t sent_ = 0;
  bool ended_ = false;
  std::string failure_;
};

// Whether the first bytes of a connection are those of TLS.
bool looks_like_tls(std::span<const std::byte> first);

}  // namespace visum::protocol
