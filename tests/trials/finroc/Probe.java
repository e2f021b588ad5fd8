// Uses Finroc's own Java libraries as finstruct does: it connects to a bridge, looks at the structure, follows a
// port, and writes by the administration interface. Prints one line for each claim, "ok" or "FAILED" first.
//   java Probe HOST:PORT PART                 a part of the scene, an arm
//   java Probe HOST:PORT MODULE BLACKBOARD    of a controller: "motion/Arm/Trajectory" "motion/Blackboards/Way"
import org.finroc.core.RuntimeEnvironment;
import org.finroc.core.RuntimeSettings;
import org.finroc.core.datatype.CoreNumber;
import org.finroc.core.datatype.CoreString;
import org.finroc.core.net.generic_protocol.Definitions;
import org.finroc.core.port.ThreadLocalCache;
import org.finroc.core.port.rpc.FutureStatus;
import org.finroc.core.port.rpc.Method;
import org.finroc.core.port.rpc.ResponseHandler;
import org.finroc.core.port.std.PortDataManager;
import org.finroc.core.remote.*;
import org.finroc.plugins.tcp.Peer;
import org.finroc.tools.finstruct.propertyeditor.ConnectingPortAccessor;

public class Probe {
  static final long PATIENCE_MS = 60000;  // a guard against waiting for ever
  static int failures = 0;
  static volatile ModelNode root = new ModelNode("none");

  interface Condition {
    boolean holds() throws Exception;
  }

  static boolean soon(Condition condition) throws Exception {
    for (long end = System.currentTimeMillis() + PATIENCE_MS; System.currentTimeMillis() < end; Thread.sleep(20)) {
      synchronized (Probe.class) {
        if (condition.holds()) return true;
      }
    }
    return false;
  }

  static boolean claim(boolean holds, String text) {
    System.out.println((holds ? "ok     " : "FAILED ") + text);
    if (!holds) failures++;
    return holds;
  }

  /** The model of what the remote side has, kept as finstruct keeps it, but without a window. */
  static class Model implements ModelHandler, ModelOperations {
    public void applyModelChanges(BufferedModelChanges changes) {
      synchronized (Probe.class) {
        changes.executeOperations(this);
      }
    }
    public void addNode(ModelNode parent, ModelNode child) { parent.add(child); }
    public void changeNodeName(ModelNode node, String name) { node.setName(name); }
    public void removeNode(ModelNode child) { if (child.getParent() != null) child.getParent().remove(child); }
    public void replaceNode(ModelNode old, ModelNode node) { old.getParent().replace(old, node); }
    public void setModelRoot(ModelNode node) { root = node; }
    public void updateModel(Runnable task) { task.run(); }
  }

  static RemotePort port(String end) {
    for (RemotePort port : root.getPortsBelow(null)) {
      if (port.getQualifiedName('/').endsWith(end)) return port;
    }
    return null;
  }

  static String written;  // the answer to the last write; null while there is none

  static String write(RemotePort port, double value) throws Exception {
    written = null;
    PortDataManager data = PortDataManager.create(CoreNumber.TYPE);
    ((CoreNumber)data.getObject().getData()).setValue(value);
    RemoteRuntime.find(port).getAdminInterface().setRemotePortValue(port, data.getObject(), new ResponseHandler() {
      public void handleResponse(Method method, Object result) { written = (String)result; }
      public void handleException(Method method, FutureStatus status) { written = "exception " + status; }
    });
    soon(() -> written != null);
    return written;
  }

  static double number(ConnectingPortAccessor<?> accessor) {
    double value = ((CoreNumber)accessor.getAutoLocked()).doubleValue();
    ThreadLocalCache.get().releaseAllLocks();
    return value;
  }

  static String text(ConnectingPortAccessor<?> accessor) {
    String value = ((CoreString)accessor.getAutoLocked()).toString();
    ThreadLocalCache.get().releaseAllLocks();
    return value;
  }

  static ConnectingPortAccessor<?> follow(RemotePort port) {
    ConnectingPortAccessor<?> accessor = new ConnectingPortAccessor<CoreNumber>(port, port.getParent().getQualifiedName('/'));
    accessor.init();
    accessor.setAutoUpdate(true);
    return accessor;
  }

  static void look(String part) throws Exception {
    if (!claim(soon(() -> port("/" + part + "/Controller Input/Desired Angle 1") != null), "connects and gets the structure")) return;
    RemotePort desired = port("/" + part + "/Controller Input/Desired Angle 1");
    RemotePort actual = port("/" + part + "/Sensor Output/Actual Angle 1");
    RemoteFrameworkElement module = (RemoteFrameworkElement)desired.getParent().getParent();
    claim(module.isTagged("module"), "the part is a module");
    claim(((RemoteFrameworkElement)desired.getParent()).isControllerInterface(), "Controller Input is a controller interface");
    claim(((RemoteFrameworkElement)actual.getParent()).isSensorInterface(), "Sensor Output is a sensor interface");
    claim(desired.getDataType().getName().equals("Number"), "a port is a Number");
    claim(soon(() -> RemoteRuntime.find(desired).getAdminInterface() != null), "finds the administration interface");
    ConnectingPortAccessor<?> angle = follow(actual);
    ConnectingPortAccessor<?> target = follow(desired);
    claim(soon(() -> number(target) != 0 || number(angle) == number(angle)), "follows a value");
    double start = number(angle);
    claim("".equals(write(desired, start + 0.05)), "writes a controller input");
    claim(soon(() -> Math.abs(number(angle) - start - 0.05) < 1e-3), "the arm moves there");
    String refusal = write(desired, 1e6);
    claim(refusal != null && refusal.contains("is not in"), "is told of a refusal: " + refusal);
    refusal = write(actual, 0);
    claim(refusal != null && refusal.contains("output"), "is told that an output is no input: " + refusal);
    Thread.sleep(1500);
    claim(Math.abs(number(angle) - start - 0.05) < 1e-3, "the arm stays there");
    latency(actual);
  }

  /** A module's parameter Speed, which is 0.8 rad/s and may be 0.05 to 2, and a blackboard with rows of numbers. */
  static void lookAtModule(String module, String blackboard) throws Exception {
    String parameters = "/" + module + "/Parameters/";
    if (!claim(soon(() -> port(parameters + "Speed") != null), "sees the parameters of a module")) return;
    RemotePort speed = port(parameters + "Speed");
    claim(((RemoteFrameworkElement)speed.getParent().getParent()).isTagged("module"), "they belong to a module");
    claim(soon(() -> RemoteRuntime.find(speed).getAdminInterface() != null), "finds the administration interface");
    ConnectingPortAccessor<?> value = follow(speed);
    claim(soon(() -> number(value) == 0.8), "follows a parameter");
    claim("".equals(write(speed, 0.5)), "writes a parameter");
    claim(soon(() -> number(value) == 0.5), "the module has the new value");
    String refusal = write(speed, 3);
    claim(refusal != null && refusal.contains("must be within 0.05 and 2"), "is told of a refusal: " + refusal);
    Thread.sleep(500);
    claim(number(value) == 0.5, "the module keeps its value");
    RemotePort board = port("/" + blackboard + "/read");
    if (!claim(board != null, "sees the blackboards of a part")) return;
    ConnectingPortAccessor<?> content = follow(board);
    claim(soon(() -> text(content).split(";").length > 3), "reads one: " + text(content));
    refusal = write(board, 0);
    claim(refusal != null && refusal.contains("output"), "is told that it cannot be written: " + refusal);
  }

  /** How old values are when they come, by their timestamps and this machine's clock. */
  static void latency(RemotePort port) throws Exception {
    ConnectingPortAccessor<?> time = follow(port("/Bridge/Sensor Output/Simulated Time"));
    long[] ages = new long[100];
    double last = number(time);
    org.finroc.core.datatype.Timestamp stamp = new org.finroc.core.datatype.Timestamp();
    for (int i = 0; i < ages.length; i++) {
      for (long end = System.currentTimeMillis() + PATIENCE_MS; number(time) == last && System.currentTimeMillis() < end; ) Thread.sleep(0, 100000);
      last = number(time);
      time.getTimestamp(stamp);
      ages[i] = System.currentTimeMillis() - stamp.getInMs();
    }
    java.util.Arrays.sort(ages);
    System.out.printf("       age of a value in the client: median %d ms, p90 %d ms, most %d ms%n", ages[50], ages[90], ages[99]);
  }

  public static void main(String[] words) throws Exception {
    RuntimeSettings.setUseCCPorts(false);
    RuntimeSettings.setMaxCoreRegisterIndexBits(19);
    RuntimeEnvironment.getInstance().setProgramName("probe");
    Peer peer = new Peer("probe", words[0], Definitions.StructureExchange.FINSTRUCT, true);
    peer.init();
    peer.connect(words[0], new Model());
    if (words.length == 2) look(words[1]);
    else lookAtModule(words[1], words[2]);
    System.out.println(failures == 0 ? "all passed" : failures + " failed");
    System.exit(failures == 0 ? 0 : 1);
  }
}
